#pragma once

#include <string>

#include "anim/timing.h"
#include "shot/reel.h"

namespace kadr {

struct VideoPlan;

/// A sound under a video with everything filled in.
struct SoundPlan {
    SoundSpec sound;
    std::string encoder;  ///< ffmpeg's name: "aac"
    int kilobits = 0;     ///< a second; 0: the encoder has no rate
    // Filled in by who knows the frames:
    Rational whole_s;   ///< duration of the whole reel, where the sound fades out
    Rational from_s;    ///< the video begins here in the reel ...
    Rational length_s;  ///< ... and is as long as this
};

/// Checks all that can be known before the first frame: ffprobe's presence, a stream of sound in the file, a container
/// that holds sound, the encoder.
/// @throws InputError  with the remedy
SoundPlan plan_sound(const SoundSpec& sound, const VideoPlan& video);

/// ffmpeg's audio filters: cut, delayed, scaled, faded, and exactly as long as the video (silence follows a short sound).
std::string sound_filter(const SoundPlan& plan);

}  // namespace kadr
