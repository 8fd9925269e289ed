#include "render/reel_picture.h"

#include "base/hash.h"
#include "base/version.h"
#include "output/blend.h"
#include "output/frame_writer.h"
#include "output/image_io.h"
#include "output/view.h"
#include "render/delivery.h"
#include "render/frame_identity.h"
#include "render/output_plan.h"

namespace kadr {
namespace {

void add(Hasher& hasher, const glm::dvec3& color) {
    for (int c = 0; c < 3; ++c) hasher.add(color[c]);
}

void add(Hasher& hasher, Rational value) {
    hasher.add(value.numerator);
    hasher.add(value.denominator);
}

}  // namespace

ReelPictures::ReelPictures(const ReelPlan& plan, std::vector<ViewSpec> views) : plan_(plan), views_(std::move(views)) {}

ReelPictures::Key ReelPictures::key_of(const ReelFrame::Layer& layer) const {
    return {plan_.source_of[static_cast<std::size_t>(layer.cut)], layer.frame};
}

const std::filesystem::path& ReelPictures::source_file(const Key& key) const {
    const auto [at, fresh] = files_.emplace(key, std::filesystem::path());
    if (fresh)
        at->second = video_source(frame_files(plan_.sources[static_cast<std::size_t>(key.first)].prepared.shot.output, key.second));
    return at->second;
}

ViewSpec ReelPictures::view_of(const Key& key) const {
    const Shot& shot = plan_.sources[static_cast<std::size_t>(key.first)].prepared.shot;
    return view_at(views_[static_cast<std::size_t>(key.first)], Sequence(shot.timing, shot.shutter).frame(key.second).time_s());
}

const Image& ReelPictures::display(const Key& key) {
    const auto known = kept_.find(key);
    if (known != kept_.end()) return known->second;
    const std::filesystem::path& file = source_file(key);
    const Image stored = image_io().read(file);
    const ViewSpec view = view_of(key);
    const Reel& reel = plan_.reel;
    return kept_[key] = centred(is_linear_file(file) ? apply_view(stored, view, false) : stored, reel.image.width,
                                reel.image.height, reel.bars);
}

Image ReelPictures::picture(int frame) {
    const ReelFrame parts = plan_.edit.frame(frame);
    std::map<Key, Image> previous = std::exchange(kept_, {});
    std::vector<BlendLayer> layers;
    for (const ReelFrame::Layer& layer : parts.layers) {
        const Key key = key_of(layer);
        if (auto node = previous.extract(key)) kept_.insert(std::move(node));
        layers.push_back({&display(key), layer.weight.value()});
    }
    std::vector<BlendColor> colors;
    for (const ReelFrame::Color& color : parts.colors) colors.push_back({color.color, color.weight.value()});
    return blend(layers, colors, plan_.reel.blend);
}

std::string ReelPictures::identity(int frame) const {
    const Reel& reel = plan_.reel;
    Hasher hasher;
    hasher.add(kVersion);
    for (const std::int64_t value : {reel.image.width, reel.image.height, static_cast<int>(reel.blend), reel.output.png_bits})
        hasher.add(value);
    add(hasher, reel.bars);
    const ReelFrame parts = plan_.edit.frame(frame);
    for (const ReelFrame::Layer& layer : parts.layers) {
        const Key key = key_of(layer);
        const ViewSpec view = view_of(key);
        hasher.add(stored_settings_hash(source_file(key)));
        hasher.add(static_cast<std::int64_t>(view.transform));
        hasher.add(view.exposure_stops);
        add(hasher, layer.weight);
    }
    for (const ReelFrame::Color& color : parts.colors) {
        add(hasher, color.color);
        add(hasher, color.weight);
    }
    return hasher.finish().hex();
}

}  // namespace kadr
