#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kadr {

/// One image file of a sequence.
struct FrameFile {
    std::filesystem::path file;
    std::string series;         ///< the name with '#' for the number: "pan.#.png"
    std::optional<int> number;  ///< the last digits of the name
};

/// The images that one side of a comparison names, in order of their series and numbers.
struct FrameSequence {
    std::string text;              ///< as the user wrote it
    std::vector<FrameFile> files;  ///< never empty
    bool single = false;           ///< one image file was named
};

/// Finds the images behind a file's name, a folder, or a pattern with {frame}, {frame:04}, %04d or #### in its last
/// part.
/// @throws InputError  nothing there, no image in the folder, a pattern without a match, a file of another kind
FrameSequence find_frames(const std::string& text);

/// The same for files that are known.
FrameSequence sequence_of(std::string text, const std::vector<std::filesystem::path>& files);

/// Two images that belong together.
struct FramePair {
    std::string label;  ///< "42", or a file's name where there is no number
    std::optional<int> number;
    std::filesystem::path reference, test;
};

/// Pairs two images; or two series by their numbers, whatever they are called; or folders that hold several series by
/// their files' names without the ending. Nothing is left out: an image without a partner is an error.
/// @param frames  numbers to compare; empty: all
/// @throws InputError  with the images that have no partner
std::vector<FramePair> pair_frames(const FrameSequence& reference, const FrameSequence& test,
                                   const std::vector<int>& frames);

}  // namespace kadr
