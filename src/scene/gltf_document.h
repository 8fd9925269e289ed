#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>
#include <tiny_gltf.h>

#include "base/error.h"
#include "base/hash.h"

namespace kadr {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

/// A glTF file whose structure has been checked: properties have their types and ranges, indices name existing objects,
/// buffer views lie within their buffers and accessors within their views, extensions are known. tinygltf maps the JSON
/// to `model`; buffers and images are read by Kadr itself (limits, no path outside the asset's folder, no copies), so
/// model.buffers and model.images stay empty.
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

    /// The bytes of a buffer view.
    ByteView view(int buffer_view) const;
    std::size_t image_count() const { return json_.contains("images") ? json_["images"].size() : 0; }
    /// The encoded bytes of an image; may be called from several threads for different images.
    /// @throws InputError when there is no such file or it leaves the asset's folder
    ByteView image(std::size_t index);
    std::string image_name(std::size_t index) const;

    /// Bytes of the file and all its buffers: what a sane scene is in proportion to.
    std::size_t total_bytes() const { return total_bytes_; }
    /// Hash of the file, its buffers and the images that were asked for.
    Hash content() const;

    /// "file: error: /accessors/3/count is 0".  `found` follows the pointer.
    [[noreturn]] void fail(std::string_view pointer, std::string_view found, std::string expected = {}) const;
    Diagnostic warning(std::string_view pointer, std::string_view found, std::string expected = {}) const;
    std::vector<Diagnostic> warnings;

private:
    std::string_view split_container();
    void parse(std::string_view text);
    void check_version() const;
    void check_extensions();
    void load_buffers();
    void check_views() const;
    void check_accessors() const;
    void load_model();
    ByteView resolve(const std::string& uri, std::string_view pointer, Bytes& storage) const;

    std::string file_;
    std::filesystem::path folder_;
    Bytes bytes_;
    ByteView binary_chunk_;
    nlohmann::json json_;
    tinygltf::Model model_;
    std::vector<Bytes> buffer_storage_, image_storage_;
    std::vector<ByteView> buffers_, images_;
    std::size_t total_bytes_ = 0;
};

/// A whole regular file. @throws InputError saying what `described_as` cannot be read and why
Bytes read_file(const std::filesystem::path& path, const Diagnostic& on_failure);

}  // namespace kadr
