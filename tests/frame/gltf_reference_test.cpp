// Whole node trees of outside glTF files against a second evaluator that knows nothing of the first: it reads the
// accessors itself and follows the formulas of glTF 2.0, appendix C, in long double. And hand-computed values of every
// kind of sampler through the whole rig.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <map>
#include <optional>
#include <random>

#include <nlohmann/json.hpp>

#include "frame/bindings.h"
#include "scene/corpus.h"
#include "stage.h"

namespace kadr {
namespace {

using Json = nlohmann::json;
using Real = long double;
using test::Stage;
using test::track;
using test::turn;

std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::string from_base64(const std::string& text) {
    const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned bits = 0, count = 0;
    for (const char c : text) {
        const std::size_t value = letters.find(c);
        if (value == std::string::npos) continue;
        bits = bits << 6 | static_cast<unsigned>(value), count += 6;
        if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 255);
    }
    return bytes;
}

using Matrix = std::array<std::array<Real, 4>, 4>;  // [row][column]

Matrix product(const Matrix& a, const Matrix& b) {
    Matrix m{};
    for (std::size_t r = 0; r < 4; ++r)
        for (std::size_t c = 0; c < 4; ++c)
            for (std::size_t k = 0; k < 4; ++k) m[r][c] += a[r][k] * b[k][c];
    return m;
}

using Values = std::vector<Real>;

/// A glTF file, read and animated by the letter of the specification.
class Reference {
public:
    explicit Reference(const std::filesystem::path& path) {
        const std::string file = bytes_of(path);
        std::string chunk;
        if (file.rfind("glTF", 0) == 0) {
            std::uint32_t size = 0;
            std::memcpy(&size, &file[12], 4);
            json_ = Json::parse(file.substr(20, size));
            if (file.size() > 28 + size) chunk = file.substr(28 + size);
        } else {
            json_ = Json::parse(file);
        }
        for (const Json& buffer : json_.value("buffers", Json::array())) {
            const std::string uri = buffer.value("uri", "");
            if (uri.empty()) buffers_.push_back(chunk);
            else if (uri.rfind("data:", 0) == 0) buffers_.push_back(from_base64(uri.substr(uri.find(',') + 1)));
            else buffers_.push_back(bytes_of(path.parent_path() / uri));
        }
    }

    std::size_t animations() const { return json_.value("animations", Json::array()).size(); }
    std::size_t nodes() const { return json_["nodes"].size(); }

    /// World transforms of all nodes with one animation at a time.
    std::vector<Matrix> worlds(std::size_t animation, Real time) const {
        std::vector<int> parent(nodes(), -1);
        for (std::size_t i = 0; i < nodes(); ++i)
            for (const Json& child : json_["nodes"][i].value("children", Json::array())) parent[child.get<std::size_t>()] = static_cast<int>(i);
        std::vector<Matrix> local;
        for (std::size_t i = 0; i < nodes(); ++i) local.push_back(local_of(i, animation, time));
        std::vector<Matrix> world = local;
        for (std::size_t i = 0; i < nodes(); ++i)
            for (int above = parent[i]; above >= 0; above = parent[static_cast<std::size_t>(above)])
                world[i] = product(local[static_cast<std::size_t>(above)], world[i]);
        return world;
    }

private:
    Values accessor(std::size_t index) const {
        const Json& a = json_["accessors"][index];
        const std::map<std::string, std::size_t> sizes{{"SCALAR", 1}, {"VEC3", 3}, {"VEC4", 4}};
        const std::size_t components = sizes.at(a["type"]), count = a["count"];
        const int type = a["componentType"];
        const std::map<int, std::size_t> widths{{5120, 1}, {5121, 1}, {5122, 2}, {5123, 2}, {5126, 4}};
        const std::size_t width = widths.at(type);
        const Json& view = json_["bufferViews"][a["bufferView"].get<std::size_t>()];
        const std::size_t stride = view.value("byteStride", width * components);
        const char* data = buffers_[view["buffer"].get<std::size_t>()].data() + view.value("byteOffset", std::size_t{0}) + a.value("byteOffset", std::size_t{0});
        Values values;
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t c = 0; c < components; ++c) values.push_back(number(data + i * stride + c * width, type));
        return values;
    }

    static Real number(const char* at, int type) {
        const auto as = [at](auto kind) {
            std::memcpy(&kind, at, sizeof kind);
            return static_cast<Real>(kind);
        };
        switch (type) {
            case 5120: return std::max(as(std::int8_t{}) / 127, Real(-1));
            case 5121: return as(std::uint8_t{}) / 255;
            case 5122: return std::max(as(std::int16_t{}) / 32767, Real(-1));
            case 5123: return as(std::uint16_t{}) / 65535;
            default: return as(float{});
        }
    }

    static void normalise(Values& q) {
        const Real length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        for (Real& v : q) v /= length;
    }

    static Values slerp(Values a, Values b, Real u) {
        normalise(a), normalise(b);
        Real d = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
        const Real sign = d < 0 ? -1 : 1;
        const Real angle = std::acos(std::min(d * sign, Real(1)));
        Values result(4);
        for (std::size_t i = 0; i < 4; ++i)
            result[i] = angle < 1e-8L ? a[i] * (1 - u) + sign * b[i] * u : (std::sin((1 - u) * angle) * a[i] + sign * std::sin(u * angle) * b[i]) / std::sin(angle);
        return result;
    }

    Values sampled(const Json& sampler, std::size_t components, Real time) const {
        const Values times = accessor(sampler["input"]), values = accessor(sampler["output"]);
        const std::string kind = sampler.value("interpolation", "LINEAR");
        const std::size_t per_key = components * (kind == "CUBICSPLINE" ? 3 : 1), middle = kind == "CUBICSPLINE" ? components : 0;
        const auto part = [&](std::size_t key, std::size_t offset) {
            const auto begin = values.begin() + static_cast<std::ptrdiff_t>(key * per_key + offset);
            return Values(begin, begin + static_cast<std::ptrdiff_t>(components));
        };
        const auto finished = [&](Values v) {
            if (components == 4) normalise(v);
            return v;
        };
        if (time <= times.front()) return finished(part(0, middle));
        if (time >= times.back()) return finished(part(times.size() - 1, middle));
        std::size_t k = 0;
        while (times[k + 1] <= time) ++k;
        const Real seconds = times[k + 1] - times[k], u = (time - times[k]) / seconds;
        const Values a = part(k, middle), b = part(k + 1, middle);
        if (kind == "STEP") return finished(a);
        if (kind == "LINEAR" && components == 4) return slerp(a, b, u);
        Values out(components);
        const Values a_out = kind == "LINEAR" ? a : part(k, 2 * components), b_in = kind == "LINEAR" ? b : part(k + 1, 0);
        for (std::size_t i = 0; i < components; ++i)
            out[i] = kind == "LINEAR" ? a[i] + u * (b[i] - a[i])
                                      : (2 * u * u * u - 3 * u * u + 1) * a[i] + seconds * (u * u * u - 2 * u * u + u) * a_out[i] +
                                            (3 * u * u - 2 * u * u * u) * b[i] + seconds * (u * u * u - u * u) * b_in[i];
        return finished(out);
    }

    Matrix local_of(std::size_t index, std::size_t animation, Real time) const {
        const Json& node = json_["nodes"][index];
        if (node.contains("matrix")) {
            Matrix m{};
            for (std::size_t i = 0; i < 16; ++i) m[i % 4][i / 4] = static_cast<Real>(node["matrix"][i].get<double>());
            return m;
        }
        const auto own = [&](const char* name, Values values) {
            if (node.contains(name))
                for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<Real>(node[name][i].get<double>());
            return values;
        };
        Values t = own("translation", {0, 0, 0}), q = own("rotation", {0, 0, 0, 1}), s = own("scale", {1, 1, 1});
        if (animations() > 0)
            for (const Json& channel : json_["animations"][animation]["channels"]) {
                if (!channel["target"].contains("node") || channel["target"]["node"] != index) continue;
                const std::string path = channel["target"]["path"];
                const Json& sampler = json_["animations"][animation]["samplers"][channel["sampler"].get<std::size_t>()];
                if (path == "translation") t = sampled(sampler, 3, time);
                if (path == "rotation") q = sampled(sampler, 4, time);
                if (path == "scale") s = sampled(sampler, 3, time);
            }
        normalise(q);
        const Real x = q[0], y = q[1], z = q[2], w = q[3];
        return {{{(1 - 2 * (y * y + z * z)) * s[0], 2 * (x * y - w * z) * s[1], 2 * (x * z + w * y) * s[2], t[0]},
                 {2 * (x * y + w * z) * s[0], (1 - 2 * (x * x + z * z)) * s[1], 2 * (y * z - w * x) * s[2], t[1]},
                 {2 * (x * z - w * y) * s[0], 2 * (y * z + w * x) * s[1], (1 - 2 * (x * x + y * y)) * s[2], t[2]},
                 {0, 0, 0, 1}}};
    }

    Json json_;
    std::vector<std::string> buffers_;
};

/// A shot of one file that plays one clip.
Shot shot_of(const std::filesystem::path& path, std::size_t clip, bool plays) {
    Stage stage;
    Shot shot = stage.shot;
    shot.scenes[0].gltf = path;
    shot.scenes[0].layers[0].clips = plays ? ClipLayer::Clips::one : ClipLayer::Clips::none;
    shot.scenes[0].layers[0].clip_index = static_cast<int>(clip);
    return shot;
}

/// Largest difference of a world matrix, over the size of that matrix.
double difference(const glm::dmat4& is, const Matrix& wanted) {
    double worst = 0, size = 0;
    for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = 0; c < 4; ++c) {
            const double value = is[static_cast<int>(c)][static_cast<int>(r)];
            worst = std::max(worst, std::abs(static_cast<double>(static_cast<Real>(value) - wanted[r][c])));
            size = std::max(size, std::abs(value));
        }
    return worst / size;
}

/// Nothing for a file that asks for what is not supported, which the loader refuses by name.
std::optional<Scene> scene_of(const std::filesystem::path& path) {
    LoadOptions options;
    options.decode_textures = false;
    try {
        return load_scene({{"stage", path, {}}}, options);
    } catch (const InputError& error) {
        std::cout << path.filename().string() << " left out: " << error.diagnostics().front().found << "\n";
        return std::nullopt;
    }
}

class GltfReference : public testing::TestWithParam<const char*> {};

TEST_P(GltfReference, AgreesAtRandomTimes) {
    KADR_NEED_ASSETS();
    const std::filesystem::path folder = test::assets_folder() / GetParam();
    if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no " << folder;
    std::mt19937_64 random(20240607);
    for (const std::filesystem::path& path : test::gltf_files(folder)) {
        const std::optional<Scene> loaded = scene_of(path);
        if (!loaded) continue;
        const Scene& scene = *loaded;
        const Reference reference(path);
        ASSERT_EQ(scene.nodes.size(), reference.nodes());
        double worst = 0;
        int compared = 0;
        for (std::size_t animation = 0; animation < std::max<std::size_t>(reference.animations(), 1); ++animation) {
            const bool plays = reference.animations() > 0 && scene.clips.at(animation).animates();
            const Shot shot = shot_of(path, animation, plays);
            const BoundShot bound(shot, scene);
            const double end = plays ? scene.clips[animation].end_s : 1;
            std::uniform_real_distribution<double> times(-0.1 * end, 1.1 * end);
            for (int i = 0; i < 40; ++i) {
                const double time = times(random);
                const std::vector<glm::dmat4> is = bound.node_transforms(time);
                const std::vector<Matrix> wanted = reference.worlds(animation, static_cast<Real>(time));
                for (std::size_t node = 0; node < is.size(); ++node, ++compared) worst = std::max(worst, difference(is[node], wanted[node]));
            }
        }
        std::cout << path.filename().string() << ": " << compared << " transforms, largest relative difference " << worst << "\n";
        EXPECT_LT(worst, 1e-13) << path;  // a few dozen products of doubles, each rounded to 1e-16; measured: 6e-16
    }
}

INSTANTIATE_TEST_SUITE_P(Outside, GltfReference,
                         testing::Values("InterpolationTest", "blender-io-06_parent-inverse-anim", "BoxAnimated", "cube-animation-playcanvas", "CesiumMilkTruck",
                                         "RiggedSimple", "Fox", "blender-io-01_cs_translate"),
                         [](const auto& file) {
                             std::string name = file.param;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

// ---- Hand-computed, through the whole rig: a node "arm" below a parent at (0, 1, 0) ----

struct Sampled : Stage {
    int parent = add_node("parent"), arm = add_node("arm", parent);
    Sampled() { node(parent).translation = {0, 1, 0}; }
    glm::dmat4 at(double time_s) const { return bind().node_transforms(time_s)[static_cast<std::size_t>(arm)]; }
    glm::dvec3 place(double time_s) const { return glm::dvec3(at(time_s)[3]); }
    double degrees(double time_s) const { return glm::degrees(std::atan2(at(time_s)[0].y, at(time_s)[0].x)); }
};

template <class T>
Track<T> spline(std::vector<std::pair<double, std::array<T, 3>>> keys) {
    Track<T> result;
    result.interpolation = Interpolation::cubic;
    for (const auto& [time, values] : keys) result.keys.push_back({time, values[1], {}, values[0], values[2]});
    return result;
}

constexpr double kExact = 1e-14;

TEST(Samplers, OfTranslations) {
    Sampled stage;
    NodeChannels& channels = stage.animate(stage.arm);
    channels.translation = track<glm::dvec3>({{1, {1, 0, 0}}, {2, {3, 0, 2}}}, Interpolation::step);
    EXPECT_EQ(stage.place(0), glm::dvec3(1, 1, 0));
    EXPECT_EQ(stage.place(1.999), glm::dvec3(1, 1, 0));
    EXPECT_EQ(stage.place(2), glm::dvec3(3, 1, 2));
    channels.translation->interpolation = Interpolation::linear;
    EXPECT_LT(glm::distance(stage.place(1.25), glm::dvec3(1.5, 1, 0.5)), kExact);
    // Two seconds from 0 (leaves with 1 a second) to 2 (arrives with -1 a second), a quarter in:
    // 2 * 1 * 0.140625 + 2 * 0.15625 + 2 * -1 * -0.046875 = 0.6875.
    channels.translation = spline<glm::dvec3>({{0, {glm::dvec3(9), {0, 0, 0}, {1, 0, 0}}}, {2, {glm::dvec3(-1, 0, 0), {2, 0, 0}, glm::dvec3(9)}}});
    EXPECT_LT(glm::distance(stage.place(0.5), glm::dvec3(0.6875, 1, 0)), kExact);
    EXPECT_LT(glm::distance(stage.place(-3), glm::dvec3(0, 1, 0)), kExact);
    EXPECT_LT(glm::distance(stage.place(3), glm::dvec3(2, 1, 0)), kExact);
}

TEST(Samplers, OfRotations) {
    Sampled stage;
    NodeChannels& channels = stage.animate(stage.arm);
    channels.rotation = track<glm::dquat>({{0, turn(10)}, {1, -turn(90)}}, Interpolation::step);
    EXPECT_NEAR(stage.degrees(0.99), 10, 1e-12);
    EXPECT_NEAR(stage.degrees(1), 90, 1e-12);
    channels.rotation->interpolation = Interpolation::linear;  // -q is the same rotation: the shorter arc, evenly
    EXPECT_NEAR(stage.degrees(0.25), 30, 1e-12);
    channels.rotation = track<glm::dquat>({{0, turn(-150)}, {1, turn(150)}});
    EXPECT_NEAR(std::abs(stage.degrees(0.5)), 180, 1e-12);  // 60 degrees back, not 300 on
    EXPECT_NEAR(stage.degrees(0.25), -165, 1e-12);
    // Components one by one, then normalised; tangents of zero: a quarter in, 0.84375 of (0, 1) and 0.15625 of (sin 45, cos 45).
    const glm::dquat none(0, 0, 0, 0);
    channels.rotation = spline<glm::dquat>({{0, {none, turn(0), none}}, {1, {none, turn(90), none}}});
    const double s = std::sqrt(0.5);
    EXPECT_NEAR(stage.degrees(0.25), glm::degrees(2 * std::atan2(0.15625 * s, 0.84375 + 0.15625 * s)), 1e-12);
    EXPECT_NEAR(stage.degrees(0.5), 45, 1e-12);
    EXPECT_NEAR(glm::determinant(stage.at(0.3)), 1, kExact);
}

TEST(Samplers, OfScales) {
    Sampled stage;
    NodeChannels& channels = stage.animate(stage.arm);
    const auto scale = [&](double time) { return glm::dvec3(stage.at(time)[0].x, stage.at(time)[1].y, stage.at(time)[2].z); };
    channels.scale = track<glm::dvec3>({{0, {1, 2, 3}}, {1, {2, 2, -1}}});
    EXPECT_LT(glm::distance(scale(0.75), glm::dvec3(1.75, 2, 0)), kExact);
    channels.scale->interpolation = Interpolation::step;
    EXPECT_EQ(scale(0.75), glm::dvec3(1, 2, 3));
    channels.scale = spline<glm::dvec3>({{0, {glm::dvec3(0), glm::dvec3(1), glm::dvec3(0, 4, 0)}}, {1, {glm::dvec3(0), glm::dvec3(3), glm::dvec3(0)}}});
    EXPECT_LT(glm::distance(scale(0.5), glm::dvec3(2, 2.5, 2)), kExact);  // 4 * 0.125 more in y
}

// A point that turns about the z axis under a parent which stretches y threefold runs along an ellipse.
TEST(Samplers, UnderANonUniformScaleFollowTheTruePath) {
    Stage stage;
    const int stretched = stage.add_node("stretched", -1, false), wheel = stage.add_node("wheel", stretched, false), rim = stage.add_node("rim", wheel);
    stage.node(stretched).scale = {1, 3, 1};
    stage.node(rim).translation = {0.5, 0, 0};
    stage.scene.geometries[0].scale = 0.2;
    stage.animate(wheel).rotation = track<glm::dquat>({{0, turn(0)}, {1, turn(120)}});
    const BoundShot bound = stage.bind();
    for (int i = 0; i <= 50; ++i) {
        const double time = i / 50.0, angle = glm::radians(120 * time);
        const glm::dmat4 world = bound.node_transforms(time)[static_cast<std::size_t>(rim)];
        EXPECT_LT(glm::distance(glm::dvec3(world[3]), glm::dvec3(0.5 * std::cos(angle), 1.5 * std::sin(angle), 0)), kExact);
        EXPECT_LT(glm::distance(glm::dvec3(world[1]), glm::dvec3(-std::sin(angle), 3 * std::cos(angle), 0)), kExact);
    }
    EXPECT_LE(test::worst_error_px(stage, stage.snapshot(), 0, rim), 0.1);
}

}  // namespace
}  // namespace kadr
