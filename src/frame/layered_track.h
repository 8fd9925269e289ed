#pragma once

#include <span>
#include <vector>

#include "frame/clip_layers.h"
#include "frame/rotation_mean.h"

namespace kadr {

/// A property that clips animate: the tracks of the layers that have it, and the value it has of its own.
///
/// Its value is the mean of the layers' values with their weights divided by their sum; where the sum is below 1 the
/// property's own value makes up for it, so that a layer whose weight runs to zero lets go of it without a jump.
/// Numbers and vectors are averaged one by one, rotations as mean_rotation has it.
template <class T>
struct LayeredTrack {
    struct Part {
        int layer = 0;  ///< into the layers that come with every call
        const Track<T>* track = nullptr;
    };
    T rest{};
    std::vector<Part> parts;  ///< none: always `rest`
};

using Layers = std::span<const PlayingLayer>;
using LayerWindows = std::span<const LayerWindow>;  ///< parallel to the layers

template <class T>
T evaluate(const LayeredTrack<T>& track, Layers layers, double time_s, double clip_offset_s);
/// The same with `own` as the property's own value.
template <class T>
T evaluate(const LayeredTrack<T>& track, const T& own, Layers layers, double time_s, double clip_offset_s);

/// Adds the track of a layer; of two tracks of one layer the later counts.
template <class T>
void add_part(LayeredTrack<T>& track, int layer, const Track<T>& source);

/// Leaves out what never counts, and makes a constant of what never changes.
template <class T>
void simplify(LayeredTrack<T>& track, Layers layers);

/// Keys inside the window, as times of the shot: those of the clips, where a pass begins or ends, and those of the
/// weights. A few hundred of them at most, whatever the speed.
template <class T>
void add_key_times(const LayeredTrack<T>& track, LayerWindows windows, std::vector<double>& times);

/// Radians that the rotation turns in the window, as an upper bound; an estimate from above where it follows curves or
/// mixes more than two rotations. Jumps of weights and of loops do not count: the window is split there.
double turn_of(const LayeredTrack<glm::dquat>& track, Layers layers, LayerWindows windows, double clip_offset_s);

/// Radians that a layer's track turns in its window.
double turn_of(const Track<glm::dquat>& track, const LayerWindow& window);

/// Between any two rotations that the mean is made of, whatever their weights.
double widest_angle(const LayeredTrack<glm::dquat>& track, Layers layers, double time_s, double clip_offset_s);

/// Whether a track of a repeated layer has another value where it starts again than where it ended, by more than the
/// rounding of a file's floats.
template <class T>
bool jumps_at_seam(const Track<T>& track, const PlayingLayer& layer);

/// Times of the shot inside the window at which a step key of a layer's track changes its value.
template <class T>
void add_steps(const Track<T>& track, const LayerWindow& window, std::vector<double>& times);

}  // namespace kadr
