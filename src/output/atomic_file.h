#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace kadr {

/// Name in the same folder for a file that is not complete yet: ".kadr-PID-STEM.tmp.EXT".
std::filesystem::path temporary_name(const std::filesystem::path& path);

/// Creates the folder of a file that is about to be written, and those above it. @throws RenderError
void create_folder_of(const std::filesystem::path& path);

/// Writes a file and waits until the disk has it. Nothing half-written stays.
/// @throws RenderError  "cannot write PATH: No space left on device; ..."
void write_synced(const std::filesystem::path& path, std::span<const unsigned char> bytes);

/// Gives a complete, synced file its final name and waits until the folder has it. @throws RenderError
void rename_synced(const std::filesystem::path& from, const std::filesystem::path& to);

/// Replaces a file so that it is either absent, its old self or complete. @throws RenderError, naming `path`
void write_atomically(const std::filesystem::path& path, std::span<const unsigned char> bytes);

/// Waits until the disk has a file that another program wrote. @throws RenderError
void sync_file(const std::filesystem::path& path);

/// Removes temporary files whose process is gone, or that are older than the process that has that number now.
void remove_dead_temporaries(const std::filesystem::path& folder);

}  // namespace kadr
