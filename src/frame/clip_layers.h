#pragma once

#include <span>
#include <vector>

#include "scene/scene.h"
#include "shot/shot.h"

namespace kadr {

/// A layer of a shot's clips with everything filled in that depends on the clips.
struct PlayingLayer {
    std::vector<int> clips;  ///< into Scene::clips; where two animate the same property the later one counts
    double at_s = 0, start_s = 0, speed = 1;
    double in_s = 0, out_s = 0;  ///< in <= out
    ClipLayer::Loop loop = ClipLayer::Loop::hold;
    Track<double> weight{1.0};

    /// Whether its clip time ever changes.
    bool runs() const { return speed != 0 && out_s > in_s; }
    /// Whether it ever counts.
    bool counts() const { return !weight.is_constant() || weight_at(0) > 0; }
    double weight_at(double time_s) const;
    /// Time of the clips at a time of the shot, in [in, out]. Where a repeated clip starts again, both of its ends
    /// fall together: the time is that of the pass that begins there.
    double clip_time(double time_s, double offset_s) const;
    /// Time of the shot when its first pass is over (pingpong: there and back); 0 where it never runs.
    double end_s() const;
    /// Time without bounds: start + speed * (t + offset - at).
    double unbounded(double time_s, double offset_s) const { return start_s + speed * (time_s + offset_s - at_s); }
};

/// @param layer  of the shot; @param clips  that it plays, at least one
PlayingLayer make_layer(const ClipLayer& layer, std::vector<int> clips, const Scene& scene);

/// A part of a window during which a layer's clip time runs evenly from one time to another.
struct ClipPass {
    double begin_s = 0, end_s = 0;  ///< of the shot
    double from_s = 0, to_s = 0;    ///< of the clip, at begin and at end
    // Never empty: from and to are more than rounding apart.
    double low_s() const { return from_s < to_s ? from_s : to_s; }
    double high_s() const { return from_s < to_s ? to_s : from_s; }
    double shot_time(double clip_s) const { return begin_s + (clip_s - from_s) / (to_s - from_s) * (end_s - begin_s); }
};

inline constexpr int kMostPasses = 128;  ///< of a layer in one window; what is faster than that is only counted

/// What a layer does during a window of the shot.
struct LayerWindow {
    const PlayingLayer* layer = nullptr;
    double begin_s = 0, end_s = 0;
    bool counts = false;        ///< whether its weight is above zero anywhere in the window
    std::vector<ClipPass> passes;   ///< those in which it runs, in order; none where it does not count
    double passes_left_out = 0; ///< beyond kMostPasses
};
LayerWindow window_of(const PlayingLayer& layer, double begin_s, double end_s, double offset_s);
std::vector<LayerWindow> windows_of(std::span<const PlayingLayer> layers, double begin_s, double end_s, double offset_s);

/// Times inside a window where a repeated clip starts again; at most kMostPasses.
std::vector<double> seams_of(const LayerWindow& window);

}  // namespace kadr
