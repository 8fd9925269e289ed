// Every number of a glTF file, whatever it is: a clear refusal, or a picture of finite pixels.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>

#include "base/error.h"
#include "extremes/child.h"
#include "extremes/full_scene.h"
#include "extremes/numbers.h"
#include "extremes/trial.h"
#include "scene/uri.h"
#include "shot/shot_parser.h"

namespace kadr::test {
namespace {

using Json = nlohmann::json;

using Bytes = std::vector<std::uint8_t>;

/// As they stand in the text: JSON knows no NaN, and what no double holds must be refused by the reader of the text.
constexpr const char* kNumbers[] = {"NaN", "Infinity", "1e400", "-1e400", "1e308", "-1e308", "1e39", "3.4028235e38", "-3.4028235e38", "1e20", "1e-20", "1e-320", "-0.0", "0", "0.5",
                                    "-1", "2147483648", "4294967296", "9223372036854775808", "18446744073709551616", "-1e19"};

const float kFloats[] = {NAN, INFINITY, -INFINITY, std::numeric_limits<float>::max(), -std::numeric_limits<float>::max(), 1e30f, -1e30f, 1e20f, 1e-20f, 1e-38f, 1e-40f, 1e-45f, -0.0f, 0.0f};

class GltfNumbers : public testing::Test {
protected:
    GltfNumbers() {
        fill_with_everything(file_);
        file_.save_gltf();  // sets the buffer
        data_ = *decode_data_uri(file_.json["buffers"][0]["uri"].get<std::string>());
        file_.json["buffers"][0]["uri"] = "scene.bin";
        save_data(data_);
        shot_ = parse_shot_text("kadr: 1\nscenes: [ { id: rig, gltf: scene.gltf } ]\ncamera: { gltf: rig/Camera }\ntiming: { frames: 12 }\n", file_.folder() / "shot.yaml");
    }

    void save_data(const Bytes& data) const { file_.save_text("scene.bin", {reinterpret_cast<const char*>(data.data()), data.size()}); }

    /// Loads and renders what is saved. @return what is wrong: "" for a clear refusal and for finite pixels
    std::string flaws() const {
        try {
            return flaws_of(shot_, load_scene({{"rig", file_.folder() / "scene.gltf", {}}}));
        } catch (const InputError& error) {
            const std::string text = error.what();
            const bool says_where = text.find("scene.gltf") != std::string::npos || text.find("shot.yaml") != std::string::npos;
            return says_where ? "" : "a refusal that does not say where: " + text;
        } catch (const std::exception& error) {
            return std::string("an exception that is no refusal: ") + error.what();
        }
    }

    void expect_sound(const ChildReport& report, const std::string& what) const {
        EXPECT_EQ(report.ended, "") << what << ": " << report.last;
        EXPECT_EQ(report.complaints, "") << what;
        EXPECT_LT(report.peak_memory_bytes, kMostMemory) << what;
    }

    GltfBuilder file_;
    Bytes data_;
    Shot shot_;
};

/// Whether a pointer leads into every third accessor or buffer view, or anywhere else: the file has dozens of them, and they are all
/// read by the same lines.
bool is_tried(const std::string& pointer) {
    constexpr int kEvery = 3;
    for (const std::string list : {"/accessors/", "/bufferViews/"})
        if (pointer.starts_with(list)) return std::stoi(pointer.substr(list.size())) % kEvery == 0;
    return true;
}

/// Pointers to the numbers of a document that are tried, by the collection that they belong to.
std::map<std::string, std::vector<std::string>> numbers_of(const Json& document) {
    std::map<std::string, std::vector<std::string>> found;
    const Json flat = document.flatten();
    for (const auto& [pointer, value] : flat.items())
        if (value.is_number() && is_tried(pointer)) found[pointer.substr(1, pointer.find('/', 1) - 1)].push_back(pointer);
    return found;
}

TEST_F(GltfNumbers, AreReadAsTheyStand) {
    expect_sound(in_child([&](ChildLog& log) {
        file_.save_gltf();
        const Scene scene = load_scene({{"rig", file_.folder() / "scene.gltf", {}}});
        for (const Diagnostic& warning : scene.warnings) log.complain(warning.text());
        if (const std::string found = flaws_of(shot_, scene); !found.empty()) log.complain(found);
    }), "the file itself");
}

TEST_F(GltfNumbers, OfTheJsonAreTakenOrRefused) {
    constexpr const char* kMark = "@number@";
    for (const auto& [collection, pointers] : numbers_of(file_.json)) {
        expect_sound(in_child([&](ChildLog& log) {
            for (const std::string& pointer : pointers) {
                Json changed = file_.json;
                changed[Json::json_pointer(pointer)] = kMark;
                const std::string text = changed.dump();
                const std::size_t at = text.find(kMark) - 1;
                for (const std::string number : kNumbers) {
                    log.begin(pointer + " = " + number);
                    file_.save_text("scene.gltf", text.substr(0, at) + number + text.substr(at + std::strlen(kMark) + 2));
                    if (const std::string found = flaws(); !found.empty()) log.complain(pointer + " = " + number + ": " + found);
                }
            }
        }), collection);
    }
}

/// Where the floats of an accessor lie in the buffer.
struct Floats {
    std::string name;
    std::size_t first, count, components;
};

std::vector<Floats> float_accessors(const Json& document) {
    const std::map<std::string, std::size_t> kComponents{{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
    std::vector<Floats> found;
    for (std::size_t i = 0; i < document["accessors"].size(); ++i) {
        const Json& accessor = document["accessors"][i];
        if (accessor["componentType"] != 5126) continue;
        found.push_back({"accessor " + std::to_string(i), document["bufferViews"][accessor["bufferView"].get<std::size_t>()]["byteOffset"], accessor["count"], kComponents.at(accessor["type"])});
    }
    return found;
}

/// The components of the first element and of the last.
std::vector<std::size_t> probed(const Floats& floats) {
    std::vector<std::size_t> indices;
    for (std::size_t c = 0; c < floats.components; ++c) {
        indices.push_back(c);
        if (floats.count > 1) indices.push_back((floats.count - 1) * floats.components + c);
    }
    return indices;
}

TEST_F(GltfNumbers, OfTheBufferAreTakenOrRefused) {
    const auto put = [](Bytes& data, const Floats& floats, std::size_t index, float value) { std::memcpy(data.data() + floats.first + index * sizeof value, &value, sizeof value); };
    for (const Floats& floats : float_accessors(file_.json)) {
        expect_sound(in_child([&](ChildLog& log) {
            const std::size_t all = floats.count * floats.components;
            const auto try_it = [&](const std::string& what, const Bytes& data) {
                log.begin(what);
                save_data(data);
                if (const std::string found = flaws(); !found.empty()) log.complain(what + ": " + found);
            };
            for (const float value : kFloats) {
                for (const std::size_t index : probed(floats)) {
                    Bytes data = data_;
                    put(data, floats, index, value);
                    try_it(floats.name + "[" + std::to_string(index) + "] = " + std::to_string(value), data);
                }
                Bytes data = data_;
                for (std::size_t index = 0; index < all; ++index) put(data, floats, index, value);
                try_it(floats.name + " = " + std::to_string(value), data);
            }
        }), floats.name);
    }
}

}  // namespace
}  // namespace kadr::test
