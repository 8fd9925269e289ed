#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "anim/timing.h"

namespace kadr {

/// One shot of a reel in whole frames of the reel.
struct Cut {
    int first = 0;      ///< frame of the shot that is seen first
    int count = 1;      ///< frames of the shot that are seen, each once; at least one
    int hold = 0;       ///< how often the last one is seen again
    int crossfade = 0;  ///< frames that overlap with the next cut
    int fade_in = 0, fade_out = 0;
    glm::dvec3 from{0}, to{0};  ///< colours of the fades, display-referred
    int length() const { return count + hold; }
    bool operator==(const Cut&) const = default;
};

/// What one frame of the reel shows: shares of frames of shots, and of plain colours. They add up to exactly 1.
struct ReelFrame {
    struct Layer {
        int cut = 0, frame = 0;  ///< index of the cut; frame of its shot
        Rational weight{1, 1};
        bool operator==(const Layer&) const = default;
    };
    struct Color {
        glm::dvec3 color{0};
        Rational weight;
    };
    std::vector<Layer> layers;  ///< one, or two within a cross-fade; in the order of the cuts
    std::vector<Color> colors;  ///< within a fade
};

/// The edit: which frames of which shots make frame N of the reel, N from 0.
///
/// Frame i of the n of a cross-fade or a fade stands for the middle of its time: what comes has the share (2 i + 1) / 2 n,
/// what goes the rest. So no frame of a transition equals its neighbour outside, and a transition run backwards is itself.
class ReelEdit {
public:
    /// @pre cross-fades and fades of a cut do not overlap, and no cross-fade follows the last cut
    explicit ReelEdit(std::vector<Cut> cuts);

    int frame_count() const { return frame_count_; }
    const std::vector<Cut>& cuts() const { return cuts_; }
    /// Frame of the reel with which a cut begins (with its cross-fade from the one before).
    int begin(int cut) const { return begins_[static_cast<std::size_t>(cut)]; }
    /// @pre 0 <= frame < frame_count()
    ReelFrame frame(int frame) const;

private:
    Rational share(int cut, int at) const;
    void add(ReelFrame& result, int cut, int at) const;

    std::vector<Cut> cuts_;
    std::vector<int> begins_;
    int frame_count_ = 0;
};

}  // namespace kadr
