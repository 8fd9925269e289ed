#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "render/reel_plan.h"

namespace kadr {

/// Makes the pictures of a reel from the files of its shots' frames.
class ReelPictures {
public:
    /// @param views  [source], with their exposure filled in: for files that are linear
    ReelPictures(const ReelPlan& plan, std::vector<ViewSpec> views);

    /// R, G, B, display-referred, of the reel's size. @throws InputError  a file that is missing or no image
    Image picture(int frame);
    /// Hash of all that affects a picture's pixels: what its shots' frames were made from, shares, colours.
    std::string identity(int frame) const;

private:
    using Key = std::pair<int, int>;  ///< source, frame of its shot
    const std::filesystem::path& source_file(const Key& key) const;
    Key key_of(const ReelFrame::Layer& layer) const;
    /// With the exposure that a frame of a source has.
    ViewSpec view_of(const Key& key) const;
    const Image& display(const Key& key);

    const ReelPlan& plan_;
    std::vector<ViewSpec> views_;
    mutable std::map<Key, std::filesystem::path> files_;
    std::map<Key, Image> kept_;   ///< those of the last frame: a hold reads its picture once
};

}  // namespace kadr
