#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include "base/error.h"
#include "base/hash.h"
#include "scene/mapped_file.h"

namespace kadr {

using Bytes = std::vector<std::uint8_t>;

/// A glTF file whose structure has been checked: properties have their types and ranges, indices name existing objects,
/// buffer views lie within their buffers and accessors within their views, extensions are known. tinygltf maps the JSON
/// to `model`; buffers and images are read by Kadr itself (limits, no path outside the asset's folder, no copies), so
/// model.buffers and model.images stay empty. Of files only what is asked for is read.
class GltfDocument {
public:
    /// @throws InputError
    explicit GltfDocument(const std::filesystem::path& path, const SourceLocation& asked_from);
    GltfDocument(const GltfDocument&) = delete;
    GltfDocument& operator=(const GltfDocument&) = delete;

    const std::string& file() const { return file_; }
    const tinygltf::Model& model() const { return model_; }
    const nlohmann::json& json() const { return json_; }
    bool uses(std::string_view extension) const;

    /// Names in `extensionsUsed`, each once: those that Kadr follows, or the others.
    std::vector<std::string> extensions(bool followed) const;

    /// The bytes of a buffer view; may be called from several threads.
    ByteView view(int buffer_view) const;
    std::size_t image_count() const { return json_.contains("images") ? json_["images"].size() : 0; }
    /// The encoded bytes of an image; may be called from several threads for different images.
    /// @throws InputError when there is no such file or it leaves the asset's folder
    ByteView image(std::size_t index);
    std::string image_name(std::size_t index) const;

    /// Bytes of the file and all its buffers: what a sane scene is in proportion to.
    std::size_t total_bytes() const { return total_bytes_; }
    /// Bytes of the same: the JSON, and the buffer views and images that were asked for.
    std::size_t read_bytes() const;
    /// Hash of the JSON, and of the buffer views and images that were asked for.
    Hash content() const;

    /// "file: error: /accessors/3/count is 0".  `found` follows the pointer.
    [[noreturn]] void fail(std::string_view pointer, std::string_view found, std::string expected = {}) const;
    Diagnostic warning(std::string_view pointer, std::string_view found, std::string expected = {}) const;
    std::vector<Diagnostic> warnings;

private:
    ByteView split_container();
    void parse(std::string_view text);
    void check_version() const;
    void check_extensions();
    void load_buffers();
    void check_views() const;
    void check_accessors() const;
    void load_model();
    /// What a URI names: a file, or the bytes that stand in it.
    struct Resource {
        MappedFile file;
        Bytes decoded;
        ByteView bytes() const { return decoded.empty() ? file.bytes() : ByteView(decoded); }
    };
    /// The JSON, and what was asked for.
    std::vector<ByteView> read_parts() const;
    Resource resolve(const std::string& uri, std::string_view pointer) const;
    ByteView bytes_of(int buffer_view) const;

    std::string file_;
    std::filesystem::path folder_;
    MappedFile container_;
    ByteView text_, binary_chunk_;  ///< of the container
    nlohmann::json json_;
    tinygltf::Model model_;
    std::vector<Resource> buffer_storage_, image_storage_;
    std::vector<ByteView> buffers_, images_;
    std::unique_ptr<std::atomic<bool>[]> asked_;  ///< [buffer view]
    std::size_t total_bytes_ = 0;
};

}  // namespace kadr
