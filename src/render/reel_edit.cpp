#include "render/reel_edit.h"

#include <algorithm>
#include <utility>

namespace kadr {
namespace {

constexpr Rational kWhole{1, 1};

/// Share of what comes, in frame `at` of the `count` of a transition.
Rational rising(int at, int count) { return make_rational(2 * at + 1, 2 * count); }

Rational rest(Rational share) { return make_rational(share.denominator - share.numerator, share.denominator); }

}  // namespace

ReelEdit::ReelEdit(std::vector<Cut> cuts) : cuts_(std::move(cuts)) {
    int next = 0;
    for (const Cut& cut : cuts_) {
        begins_.push_back(next);
        frame_count_ = next + cut.length();
        next = frame_count_ - cut.crossfade;
    }
}

ReelFrame ReelEdit::frame(int frame) const {
    ReelFrame result;
    for (std::size_t i = 0; i < cuts_.size() && begins_[i] <= frame; ++i) {
        const int at = frame - begins_[i];
        if (at < cuts_[i].length()) add(result, static_cast<int>(i), at);
    }
    return result;
}

/// Share of a cut beside its neighbour, in its own frame `at`.
Rational ReelEdit::share(int cut, int at) const {
    const Cut& here = cuts_[static_cast<std::size_t>(cut)];
    const int entering = cut > 0 ? cuts_[static_cast<std::size_t>(cut) - 1].crossfade : 0;
    const int leaving = at - (here.length() - here.crossfade);
    if (at < entering) return rising(at, entering);
    return leaving >= 0 ? rest(rising(leaving, here.crossfade)) : kWhole;
}

void ReelEdit::add(ReelFrame& result, int cut, int at) const {
    const Cut& here = cuts_[static_cast<std::size_t>(cut)];
    const int leaving = at - (here.length() - here.fade_out);
    Rational image = kWhole;
    glm::dvec3 color(0);
    if (at < here.fade_in) {
        image = rising(at, here.fade_in);
        color = here.from;
    } else if (leaving >= 0) {
        image = rest(rising(leaving, here.fade_out));
        color = here.to;
    }
    const Rational whole = share(cut, at);
    result.layers.push_back({cut, here.first + std::min(at, here.count - 1), whole * image});
    if (image != kWhole) result.colors.push_back({color, whole * rest(image)});
}

}  // namespace kadr
