#include "scene/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "scene/accessor.h"
#include "scene/gltf_schema.h"
#include "scene/uri.h"

namespace kadr {

namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kLargestJson = 256ull << 20;        // bytes; without a GLB chunk of its own, data URIs included
constexpr std::uint64_t kLargestZeros = 1ull << 30;         // bytes of accessors that have no buffer view
constexpr int kDeepestJson = 64;                            // glTF itself needs 9 levels, extensions a few more
constexpr std::string_view kDamaged = "the file is damaged; export it anew";

constexpr std::string_view kSupported[] = {"KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_materials_unlit", "KHR_materials_ior",
                                           "KHR_texture_transform", "KHR_mesh_quantization", "KHR_materials_variants", "KHR_node_visibility",
                                           "EXT_mesh_gpu_instancing", "KHR_animation_pointer"};

/// Extensions that replace data: without them a file is useless unless it carries a fallback.
struct Replacement {
    std::string_view extension, what, remedy;
};
constexpr Replacement kReplacements[] = {
    {"KHR_draco_mesh_compression", "Draco compressed meshes", "export the file without mesh compression"},
    {"EXT_meshopt_compression", "meshopt compressed buffers", "decompress the file, with gltfpack -noq or gltf-transform copy"},
    {"KHR_meshopt_compression", "meshopt compressed buffers", "decompress the file, with gltfpack -noq or gltf-transform copy"},
    {"KHR_texture_basisu", "KTX2 textures", "export the textures as PNG or JPEG"},
    {"EXT_texture_webp", "WebP textures", "export the textures as PNG or JPEG"},
    {"EXT_texture_avif", "AVIF textures", "export the textures as PNG or JPEG"},
    {"MSFT_texture_dds", "DDS textures", "export the textures as PNG or JPEG"},
};

bool is_supported(const std::string& extension) { return std::find(std::begin(kSupported), std::end(kSupported), extension) != std::end(kSupported); }

bool contains(const Json& object, std::string_view key) { return object.is_object() && object.find(key) != object.end(); }

const Json* member(const Json& object, std::string_view key) {
    if (!object.is_object()) return nullptr;
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
}

/// The items of an array member, or nothing: used before the schema has been checked.
const Json& items(const Json& object, std::string_view key) {
    static const Json kNone = Json::array();
    const Json* found = member(object, key);
    return found && found->is_array() ? *found : kNone;
}

std::vector<std::string> strings(const Json& object, std::string_view key) {
    std::vector<std::string> result;
    for (const Json& item : items(object, key))
        if (item.is_string()) result.push_back(item.get<std::string>());
    return result;
}

bool has_extension(const Json& object, std::string_view name) {
    const Json* extensions = member(object, "extensions");
    return extensions && contains(*extensions, name);
}

std::uint32_t little_endian(ByteView bytes, std::size_t at) {
    return bytes[at] | bytes[at + 1] << 8 | bytes[at + 2] << 16 | static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

/// How deep brackets nest, without building anything: recursive readers must not see a bomb.
int nesting_depth(std::string_view text) {
    int depth = 0, deepest = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted) {
            if (c == '\\') ++i;
            else if (c == '"') quoted = false;
        } else if (c == '"') {
            quoted = true;
        } else if (c == '{' || c == '[') {
            deepest = std::max(deepest, ++depth);
        } else if (c == '}' || c == ']') {
            --depth;
        }
    }
    return deepest;
}

std::size_t unsigned_or(const Json& object, std::string_view key, std::size_t otherwise) {
    const Json* value = member(object, key);
    return value ? value->get<std::size_t>() : otherwise;
}

/// Bytes of one element as it is stored; columns of matrices start at multiples of four bytes.
std::size_t stored_size(const tinygltf::Accessor& accessor) {
    const std::size_t size = component_size(accessor.componentType);
    const auto matrix = [&](std::size_t n) { return (n - 1) * ((n * size + 3) / 4 * 4) + n * size; };
    if (accessor.type == TINYGLTF_TYPE_MAT2) return matrix(2);
    if (accessor.type == TINYGLTF_TYPE_MAT3) return matrix(3);
    return size * static_cast<std::size_t>(component_count(accessor.type));
}

bool is_index_type(int component_type) {
    return component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

}  // namespace

GltfDocument::GltfDocument(const std::filesystem::path& path, const SourceLocation& asked_from)
    : file_(path.string()), folder_(path.parent_path()) {
    Diagnostic unreadable;
    unreadable.where = asked_from;
    unreadable.found = fmt::format("cannot read {}", file_);
    unreadable.expected = "expected a glTF 2.0 file (.gltf or .glb); paths are relative to the shot file";
    container_ = MappedFile(path, unreadable);
    total_bytes_ = container_.bytes().size();
    text_ = split_container();
    parse(std::string_view(reinterpret_cast<const char*>(text_.data()), text_.size()));
    check_version();
    check_extensions();
    if (auto problems = check_schema(json_, file_); !problems.empty()) throw InputError(std::move(problems));
    load_model();
    asked_ = std::make_unique<std::atomic<bool>[]>(model_.bufferViews.size());
    load_buffers();
    check_views();
    check_accessors();
    image_storage_.resize(image_count());
    images_.resize(image_count());
}

void GltfDocument::fail(std::string_view pointer, std::string_view found, std::string expected) const {
    Diagnostic problem = warning(pointer, found, std::move(expected));
    problem.warning = false;
    throw InputError(std::move(problem));
}

Diagnostic GltfDocument::warning(std::string_view pointer, std::string_view found, std::string expected) const {
    Diagnostic result;
    result.where.file = file_;
    result.found = pointer.empty() ? std::string(found) : fmt::format("{} {}", pointer, found);
    result.expected = std::move(expected);
    result.warning = true;
    return result;
}

bool GltfDocument::uses(std::string_view extension) const {
    const auto used = strings(json_, "extensionsUsed");
    return std::find(used.begin(), used.end(), extension) != used.end();
}

std::vector<std::string> GltfDocument::extensions(bool followed) const {
    std::vector<std::string> names;
    for (const std::string& name : strings(json_, "extensionsUsed"))
        if (is_supported(name) == followed && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    return names;
}

/// The JSON text; for GLB also finds the binary chunk.  Source: glTF 2.0 specification, section 4 (GLB).
ByteView GltfDocument::split_container() {
    constexpr std::size_t kHeader = 12, kChunkHeader = 8;
    constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
    const ByteView bytes = container_.bytes();
    if (bytes.size() < 4 || std::memcmp(bytes.data(), "glTF", 4) != 0) return bytes;
    if (bytes.size() < kHeader + kChunkHeader)
        fail({}, fmt::format("the GLB file ends after {} bytes", bytes.size()), "expected a header and a JSON chunk; the file is truncated");
    if (const std::uint32_t version = little_endian(bytes, 4); version != 2)
        fail({}, fmt::format("is GLB version {}", version), "expected version 2; convert the file to glTF 2.0");
    const std::uint32_t length = little_endian(bytes, 8);
    if (length > bytes.size())
        fail({}, fmt::format("the GLB header says {} bytes, the file has {}", length, bytes.size()), "the file is truncated; copy or export it anew");
    ByteView rest = bytes.subspan(0, length);
    rest = rest.subspan(std::min<std::size_t>(kHeader, rest.size()));
    ByteView document;
    for (int chunk = 0; rest.size() >= kChunkHeader; ++chunk) {
        const std::uint32_t size = little_endian(rest, 0), type = little_endian(rest, 4);
        rest = rest.subspan(kChunkHeader);
        if (size > rest.size())
            fail({}, fmt::format("GLB chunk {} says {} bytes, {} are left", chunk, size, rest.size()), "the file is truncated; copy or export it anew");
        if (chunk == 0 && type != kJson) fail({}, "the first GLB chunk is not JSON", std::string(kDamaged));
        if (chunk == 0) document = rest.subspan(0, size);
        if (chunk == 1 && type == kBinary) binary_chunk_ = rest.subspan(0, size);
        rest = rest.subspan(size);
    }
    return document;
}

void GltfDocument::parse(std::string_view text) {
    if (text.empty()) fail({}, container_.bytes().empty() ? "is empty" : "holds no JSON", "expected a glTF 2.0 file (.gltf or .glb)");
    if (text.size() > kLargestJson && !binary_chunk_.empty())
        fail({}, fmt::format("holds {} bytes of JSON", text.size()), "expected at most 256 MiB");
    if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
    if (const int depth = nesting_depth(text); depth > kDeepestJson)
        fail({}, fmt::format("its JSON nests {} levels deep", depth), fmt::format("expected at most {} levels", kDeepestJson));
    try {
        json_ = Json::parse(text);
    } catch (const Json::exception& error) {  // of its grammar, or of a number that no double holds
        // The library's text up to "; expected" says where and what; its prefix is a code of its own.
        std::string why = error.what();
        if (const std::size_t end = why.find("] "); end != std::string::npos) why.erase(0, end + 2);
        fail({}, "is not valid JSON: " + why, "expected a glTF 2.0 file (.gltf or .glb)");
    }
    if (!json_.is_object()) fail({}, "its JSON is not an object", "expected a glTF 2.0 file (.gltf or .glb)");
}

void GltfDocument::check_version() const {
    const Json* asset = member(json_, "asset");
    const Json* version = asset ? member(*asset, "version") : nullptr;
    if (!version || !version->is_string()) {
        if (contains(json_, "asset") && version) fail("/asset/version", "is not a string", "expected \"2.0\"");
        fail("/asset/version", "is missing", "expected \"2.0\"; glTF 1.0 files must be converted first");
    }
    const auto& text = version->get_ref<const std::string&>();
    if (text.substr(0, 2) != "2.")
        fail("/asset/version", fmt::format("is \"{}\"", text.substr(0, 20)), "expected \"2.0\"; convert the file to glTF 2.0");
    const Json* minimum = member(*asset, "minVersion");
    if (minimum && minimum->is_string() && *minimum != "2.0")
        fail("/asset/minVersion", fmt::format("is \"{}\"", minimum->get_ref<const std::string&>().substr(0, 20)), "Kadr reads glTF 2.0");
}

void GltfDocument::check_extensions() {
    const auto required = strings(json_, "extensionsRequired");
    for (std::size_t i = 0; i < required.size(); ++i) {
        if (is_supported(required[i])) continue;
        const std::string pointer = fmt::format("/extensionsRequired/{}", i);
        for (const Replacement& replacement : kReplacements)
            if (replacement.extension == required[i])
                fail(pointer, fmt::format("is {}: {} are not supported yet", required[i], replacement.what), std::string(replacement.remedy));
        fail(pointer, fmt::format("is {}, which Kadr does not support", required[i].substr(0, 80)), "export the file without requiring that extension");
    }
    for (const std::string& name : extensions(false))
        warnings.push_back(warning("/extensionsUsed", fmt::format("names {}, which is not supported and has no effect", name)));
}

void GltfDocument::load_model() {
    Json known = known_members(json_);
    const auto each_primitive = [](Json& document, const auto& visit) {
        if (!document.contains("meshes")) return;
        for (std::size_t m = 0; m < document["meshes"].size(); ++m)
            for (std::size_t p = 0; p < document["meshes"][m]["primitives"].size(); ++p) visit(m, p, document["meshes"][m]["primitives"][p]);
    };
    // tinygltf refuses index accessors that are sparse alone; they are put back below.
    each_primitive(known, [](std::size_t, std::size_t, Json& primitive) { primitive.erase("indices"); });
    const std::string text = known.dump(-1, ' ', false, Json::error_handler_t::replace);
    tinygltf::TinyGLTF reader;
    std::string errors, notes;
    bool done = false;
    try {
        done = reader.LoadASCIIFromString(&model_, &errors, &notes, text.data(), static_cast<unsigned>(text.size()), folder_.string());
    } catch (const std::exception& error) {
        errors += error.what();
    }
    const auto first_line = errors.substr(0, errors.find('\n'));
    if (!done) fail({}, "cannot be read: " + (first_line.empty() ? "unknown structure" : first_line), std::string(kDamaged));
    const auto same = [&](std::string_view key, std::size_t count) {
        if (items(json_, key).size() != count) fail(fmt::format("/{}", key), "holds something that cannot be read", std::string(kDamaged));
    };
    same("accessors", model_.accessors.size());
    same("bufferViews", model_.bufferViews.size());
    same("materials", model_.materials.size());
    same("meshes", model_.meshes.size());
    same("nodes", model_.nodes.size());
    same("textures", model_.textures.size());
    same("samplers", model_.samplers.size());
    same("cameras", model_.cameras.size());
    same("scenes", model_.scenes.size());
    same("skins", model_.skins.size());
    same("animations", model_.animations.size());
    each_primitive(json_, [&](std::size_t m, std::size_t p, const Json& primitive) {
        model_.meshes[m].primitives.at(p).indices = static_cast<int>(unsigned_or(primitive, "indices", static_cast<std::size_t>(-1)));
    });
}

GltfDocument::Resource GltfDocument::resolve(const std::string& uri, std::string_view pointer) const {
    if (uri.substr(0, 5) == "data:") {
        auto decoded = decode_data_uri(uri);
        if (!decoded) fail(pointer, "is not a well-formed data URI", "expected \"data:...;base64,\" and base64 text");
        return {{}, std::move(*decoded)};
    }
    const auto relative = path_within_folder(uri);
    if (!relative)
        fail(pointer, fmt::format("is \"{}\"", uri.substr(0, 200)), "expected a relative path that stays in the asset's folder; copy the file next to the asset");
    Diagnostic unreadable = warning(pointer, fmt::format("is \"{}\"", uri.substr(0, 200)), "expected a readable file next to the asset");
    unreadable.warning = false;
    return {MappedFile(folder_ / *relative, unreadable), {}};
}

void GltfDocument::load_buffers() {
    const Json& list = items(json_, "buffers");
    buffers_.resize(list.size());
    buffer_storage_.resize(list.size());
    std::vector<bool> used(list.size());
    for (const tinygltf::BufferView& view : model_.bufferViews) used[static_cast<std::size_t>(view.buffer)] = true;
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (!used[i]) continue;
        const std::string pointer = fmt::format("/buffers/{}", i);
        const auto length = unsigned_or(list[i], "byteLength", 0);
        if (const Json* uri = member(list[i], "uri")) {
            buffer_storage_[i] = resolve(uri->get_ref<const std::string&>(), pointer + "/uri");
            buffers_[i] = buffer_storage_[i].bytes();
            total_bytes_ += buffers_[i].size();
        } else if (i == 0 && !binary_chunk_.empty()) {
            buffers_[i] = binary_chunk_;
        } else {
            for (const char* compression : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
                if (has_extension(list[i], compression))
                    fail(pointer, fmt::format("holds no data outside {}: meshopt compressed buffers are not supported yet", compression),
                         "decompress the file, with gltfpack -noq or gltf-transform copy");
            fail(pointer, "has no uri", "expected a file or data URI, or in a GLB file the binary chunk; " + std::string(kDamaged));
        }
        if (buffers_[i].size() < length)
            fail(pointer + "/byteLength", fmt::format("is {}, its data has {} bytes", length, buffers_[i].size()), "the data is truncated; copy or export it anew");
        buffers_[i] = buffers_[i].subspan(0, length);
    }
}

void GltfDocument::check_views() const {
    for (std::size_t i = 0; i < model_.bufferViews.size(); ++i) {
        const tinygltf::BufferView& view = model_.bufferViews[i];
        const std::size_t size = buffers_[static_cast<std::size_t>(view.buffer)].size();
        if (view.byteOffset > size || view.byteLength > size - view.byteOffset)
            fail(fmt::format("/bufferViews/{}", i), fmt::format("covers bytes {} to {}, buffer {} has {}", view.byteOffset, view.byteOffset + view.byteLength, view.buffer, size),
                 "expected a range inside the buffer; " + std::string(kDamaged));
    }
}

void GltfDocument::check_accessors() const {
    std::uint64_t zeros = 0;
    const auto fits = [&](const std::string& pointer, int view_index, std::size_t offset, std::size_t stride, std::size_t size, std::size_t count) {
        const std::uint64_t available = bytes_of(view_index).size();
        const std::uint64_t last = (static_cast<std::uint64_t>(count) - 1) * stride;  // at most 2^31 * 252
        if (offset > available || last + size > available - offset)
            fail(pointer, fmt::format("needs {} bytes from offset {}, buffer view {} has {}", last + size, offset, view_index, available),
                 "expected a range inside the buffer view; " + std::string(kDamaged));
    };
    for (std::size_t i = 0; i < model_.accessors.size(); ++i) {
        const tinygltf::Accessor& accessor = model_.accessors[i];
        const std::string pointer = fmt::format("/accessors/{}", i);
        if (component_size(accessor.componentType) == 0)
            fail(pointer + "/componentType", fmt::format("is {}", accessor.componentType), "expected one of: 5120 5121 5122 5123 5125 5126");
        const std::size_t size = stored_size(accessor);
        if (accessor.bufferView >= 0) {
            const std::size_t given = model_.bufferViews[static_cast<std::size_t>(accessor.bufferView)].byteStride;
            if (given && given < size)
                fail(fmt::format("/bufferViews/{}/byteStride", accessor.bufferView), fmt::format("is {}", given),
                     fmt::format("expected at least the {} bytes of an element of accessor {}", size, i));
            fits(pointer, accessor.bufferView, accessor.byteOffset, given ? given : size, size, accessor.count);
        } else if (zeros += static_cast<std::uint64_t>(size) * accessor.count; zeros > kLargestZeros) {
            fail(pointer + "/count", fmt::format("is {} without a buffer view", accessor.count), "expected at most 1 GiB of zeros in a file");
        }
        if (!accessor.sparse.isSparse) continue;
        const auto& sparse = accessor.sparse;
        const auto count = static_cast<std::size_t>(sparse.count);
        if (count > accessor.count)
            fail(pointer + "/sparse/count", fmt::format("is {}", sparse.count), fmt::format("expected at most the accessor's count, {}", accessor.count));
        if (!is_index_type(sparse.indices.componentType))
            fail(pointer + "/sparse/indices/componentType", fmt::format("is {}", sparse.indices.componentType), "expected one of: 5121 5123 5125");
        const std::size_t index_size = component_size(sparse.indices.componentType);
        fits(pointer + "/sparse/indices", sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), index_size, index_size, count);
        fits(pointer + "/sparse/values", sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), size, size, count);
    }
}

ByteView GltfDocument::view(int index) const {
    asked_[static_cast<std::size_t>(index)].store(true, std::memory_order_relaxed);
    return bytes_of(index);
}

ByteView GltfDocument::bytes_of(int index) const {
    const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(index)];
    return buffers_[static_cast<std::size_t>(view.buffer)].subspan(view.byteOffset, view.byteLength);
}

ByteView GltfDocument::image(std::size_t index) {
    if (!images_[index].empty()) return images_[index];
    const Json& image = json_["images"][index];
    const std::string pointer = fmt::format("/images/{}", index);
    if (const Json* uri = member(image, "uri")) {
        image_storage_[index] = resolve(uri->get_ref<const std::string&>(), pointer + "/uri");
        images_[index] = image_storage_[index].bytes();
    } else if (const Json* stored = member(image, "bufferView")) {
        images_[index] = view(stored->get<int>());
    } else {
        fail(pointer, "has neither uri nor bufferView", std::string(kDamaged));
    }
    if (images_[index].empty()) fail(pointer, "is empty", "expected a PNG or JPEG image");
    return images_[index];
}

std::string GltfDocument::image_name(std::size_t index) const {
    const Json& image = json_["images"][index];
    const Json* uri = member(image, "uri");
    if (uri && uri->get_ref<const std::string&>().substr(0, 5) != "data:") return percent_decode(uri->get_ref<const std::string&>());
    if (const Json* name = member(image, "name")) return name->get<std::string>();
    return fmt::format("image {}", index);
}

std::vector<ByteView> GltfDocument::read_parts() const {
    std::vector<ByteView> parts{text_};
    for (std::size_t i = 0; i < model_.bufferViews.size(); ++i)
        if (asked_[i].load(std::memory_order_relaxed)) parts.push_back(bytes_of(static_cast<int>(i)));
    for (const Resource& image : image_storage_) parts.push_back(image.bytes());
    return parts;
}

std::size_t GltfDocument::read_bytes() const {
    std::size_t bytes = 0;
    for (const ByteView part : read_parts()) bytes += part.size();
    return bytes;
}

Hash GltfDocument::content() const {
    Hasher hasher;
    for (const ByteView part : read_parts()) hasher.add(std::string_view(reinterpret_cast<const char*>(part.data()), part.size()));
    return hasher.finish();
}

}  // namespace kadr
