// Our motion against HIPRT's own transform code, built for the host (HIPRT_EXPORTS); and its hazards that can be seen
// there: each of these tests fails when HIPRT has mended one, which is when we can stop to work around it.
//
// Built only where CMake finds HIPRT's headers (see CMakeLists.txt), of version 2.5 or later.
#define HIPRT_EXPORTS
#include <hiprt/impl/Transform.h>
#include <hiprt/impl/Triangle.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <type_traits>

#include "device/tables/motion_keys.h"
#include "kernels/scene/motion.h"

namespace kadr::test {
namespace {

constexpr float kPiF = 3.14159265358979f;
constexpr float kTolerance = 1e-5f;  ///< of the largest coordinate: a hundred roundings of single precision

using Library = hiprt::Frame;

/// A frame as HIPRT keeps it, from the bytes that a build is given.
template <class Given, class Older, class Frame = Library, class Bytes>
Frame from_bytes(const Bytes& bytes) {
    static_assert(sizeof(Given) == sizeof(Bytes), "our layouts are HIPRT's");
    if constexpr (std::is_constructible_v<Frame, const Given&>) {
        Given given;
        std::memcpy(static_cast<void*>(&given), &bytes, sizeof(Bytes));
        return Frame(given);
    } else {  // before version 3.0
        static_assert(sizeof(Older) == sizeof(Bytes));
        Older older;
        std::memcpy(static_cast<void*>(&older), &bytes, sizeof(Bytes));
        return older.convert();
    }
}
Library library_frame(const kernels::FrameSrt& f) { return from_bytes<hiprtFrameSRT, hiprt::SRTFrame>(f); }
Library library_frame(const kernels::FrameMatrix& f) { return from_bytes<hiprtFrameMatrix, hiprt::MatrixFrame>(f); }

/// The frames of one instance, for both sides.
struct Frames {
    MotionFrames ours;
    std::vector<Library> theirs;

    template <class Frame>
    explicit Frames(const std::vector<Frame>& frames) {
        constexpr bool kSrt = std::is_same_v<Frame, kernels::FrameSrt>;
        ours.headers.push_back({0, static_cast<unsigned>(frames.size())});
        ours.types.push_back(kSrt ? FrameType::srt : FrameType::matrix);
        for (const Frame& f : frames) {
            if constexpr (kSrt)
                ours.srt.push_back(f);
            else
                ours.matrices.push_back(f);
            theirs.push_back(library_frame(f));
        }
    }

    kernels::Affine our_place(float time) const {
        std::vector<kernels::TransformKey> keys;
        for (std::size_t i = 0; i < theirs.size(); ++i) keys.push_back(key_at(ours, 0, i));
        kernels::InstanceMotion motion{0, static_cast<unsigned>(keys.size()), kernels::InstanceMotion::Kind::keys,
                                       false};
        kernels::SceneView view{};
        view.motions = &motion;
        view.keys = keys.data();
        return kernels::transform_at(view, 0, time);
    }
    hiprt::Transform transform() const { return {theirs.data(), 0, static_cast<uint32_t>(theirs.size())}; }
    Library their_place(float time) const { return transform().interpolateFrames(time); }
};

float3 apply(const kernels::Affine& a, const float3& p) {
    return {a.m[0][0] * p.x + a.m[0][1] * p.y + a.m[0][2] * p.z + a.m[0][3],
            a.m[1][0] * p.x + a.m[1][1] * p.y + a.m[1][2] * p.z + a.m[1][3],
            a.m[2][0] * p.x + a.m[2][1] * p.y + a.m[2][2] * p.z + a.m[2][3]};
}

float largest(const float3& p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }
float distance(const float3& a, const float3& b) { return largest({a.x - b.x, a.y - b.y, a.z - b.z}); }

/// Rotation by angle about an axis, then scaled before it, in double.
kernels::FrameMatrix matrix_frame(const kernels::FrameSrt& f) {
    const kernels::Affine a = [&] {
        MotionFrames one;
        one.headers.push_back({0, 1});
        one.types.push_back(FrameType::srt);
        one.srt.push_back(f);
        return matrix_at(one, 0, 0);
    }();
    kernels::FrameMatrix m{};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j) m.matrix[i][j] = a.m[i][j];
    m.time = f.time;
    return m;
}

class RandomFrames {
public:
    explicit RandomFrames(unsigned seed) : random_(seed) {}

    float uniform(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
    int count() { return std::uniform_int_distribution<int>(2, 6)(random_); }

    /// Turning by less than 170 degrees from frame to frame (the shorter arc of half a turn has no direction), of
    /// scales from 0.1 to 10 that keep their signs, two thirds of the sets mirrored on some axis.
    std::vector<kernels::FrameSrt> srt() {
        const int n = count();
        float sign[3];
        for (float& s : sign) s = uniform(0, 1) < 0.3f ? -1.0f : 1.0f;
        glm::dquat turn = rotation(kPiF);
        std::vector<kernels::FrameSrt> frames;
        for (int k = 0; k < n; ++k) {
            kernels::FrameSrt f{};
            for (int i = 0; i < 3; ++i) {
                f.scale[i] = sign[i] * std::pow(10.0f, uniform(-1, 1));
                f.translation[i] = uniform(-5, 5);
            }
            glm::dvec3 axis = glm::axis(turn);
            double angle = glm::angle(turn);
            if (angle > glm::pi<double>()) angle -= 2 * glm::pi<double>();
            for (int i = 0; i < 3; ++i) f.axis[i] = static_cast<float>(axis[i]);
            f.angle = static_cast<float>(angle);
            f.time = static_cast<float>(k) / static_cast<float>(n - 1);
            frames.push_back(f);
            turn = glm::normalize(turn * rotation(uniform(0, 1) < 0.3f ? 0.05f : 170.0f / 180.0f * kPiF));
        }
        return frames;
    }

    /// The same with shear: a row scaled unevenly after the turn.
    std::vector<kernels::FrameMatrix> matrices(bool sheared) {
        std::vector<kernels::FrameMatrix> frames;
        float stretch[3] = {1, 1, 1};
        if (sheared)
            for (float& s : stretch) s = uniform(0.5f, 2);
        for (const kernels::FrameSrt& f : srt()) {
            frames.push_back(matrix_frame(f));
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) frames.back().matrix[i][j] *= stretch[i];
        }
        return frames;
    }

    float3 point() { return {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; }

private:
    glm::dquat rotation(float most) {
        const glm::dvec3 axis = glm::normalize(glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)) + 1e-9);
        return glm::angleAxis(static_cast<double>(uniform(-most, most)), axis);
    }

    std::mt19937 random_;
};

/// Largest distance between our place of a point and HIPRT's, relative to the size of what is placed.
float deviation(RandomFrames& random, const Frames& frames) {
    float worst = 0;
    for (int i = 0; i < 3; ++i) {
        const float time = i == 0 ? 1.0f : random.uniform(0, 1);
        const kernels::Affine ours = frames.our_place(time);
        const Library theirs = frames.their_place(time);
        float size = 0;
        for (const auto& row : ours.m)
            for (const float x : row) size = std::max(size, std::abs(x));
        const float3 p = random.point();
        worst = std::max(worst, distance(apply(ours, p), theirs.transform(p)) / size);
    }
    return worst;
}

constexpr int kSets = 100'000;

TEST(HiprtMotion, InterpolatesSrtFramesAsWeDo) {
    RandomFrames random(1);
    float worst = 0;
    for (int i = 0; i < kSets / 2; ++i) worst = std::max(worst, deviation(random, Frames(random.srt())));
    EXPECT_LT(worst, kTolerance);
    RecordProperty("worst", std::to_string(worst));
}

TEST(HiprtMotion, InterpolatesMatrixFramesAsWeDo) {
    RandomFrames random(2);
    float worst = 0;
    for (int i = 0; i < kSets / 2; ++i)
        worst = std::max(worst, deviation(random, Frames(random.matrices((i & 1) != 0))));
    EXPECT_LT(worst, kTolerance);
    RecordProperty("worst", std::to_string(worst));
}

TEST(HiprtMotion, InvertsWhatIsNotShearedAsItPlacesIt) {
    RandomFrames random(3);
    float worst = 0;
    for (int i = 0; i < kSets / 10; ++i) {
        const Frames frames(random.srt());
        const float time = random.uniform(0, 1);
        const Library at = frames.their_place(time);
        const float3 p = random.point();
        // Scales down to 0.1 enlarge what rounding leaves of coordinates up to 25.
        worst = std::max(worst, distance(at.invTransform(apply(frames.our_place(time), p)), p) * 0.1f / 25);
    }
    EXPECT_LT(worst, kTolerance);
}

// ------------------------------------------------------------------------------------------------------------ hazards

kernels::FrameSrt srt(float angle, float time, kernels::Vec3f scale = {1, 1, 1},
                      kernels::Vec3f translation = {0, 0, 0}) {
    return {{0, 0, 1}, angle, {scale.x, scale.y, scale.z}, {translation.x, translation.y, translation.z}, time, 0};
}

Library at_time(const std::vector<kernels::FrameSrt>& frames, float time) { return Frames(frames).their_place(time); }

TEST(HiprtHazards, TimeZeroIsTheFirstFrameEvenInTheMiddleOfAShutter) {
    const std::vector<kernels::FrameSrt> frames{srt(0, -1), srt(0, 1, {1, 1, 1}, {2, 0, 0})};
    EXPECT_EQ(at_time(frames, 0.0f).m_translation.x, 0.0f);
    EXPECT_NEAR(at_time(frames, 1e-6f).m_translation.x, 1.0f, 1e-5f);
}

TEST(HiprtHazards, TimesOutsideTheFramesClamp) {
    const std::vector<kernels::FrameSrt> frames{srt(0, 0, {1, 1, 1}, {1, 0, 0}), srt(0, 1, {1, 1, 1}, {2, 0, 0})};
    EXPECT_EQ(at_time(frames, -3.0f).m_translation.x, 1.0f);
    EXPECT_EQ(at_time(frames, 3.0f).m_translation.x, 2.0f);
}

TEST(HiprtHazards, UnsortedTimesAreSilentlyWrong) {
    const std::vector<kernels::FrameSrt> frames{srt(0, 0), srt(0, 1, {1, 1, 1}, {4, 0, 0}),
                                                srt(0, 0.5f, {1, 1, 1}, {2, 0, 0})};
    EXPECT_NE(at_time(frames, 0.75f).m_translation.x, 3.0f);
}

TEST(HiprtHazards, SmallRotationsAreTakenForTheIdentity) {
    const float3 p{1000, 0, 0};
    EXPECT_EQ(library_frame(srt(4.8e-4f, 0)).transform(p).y, 0.0f);
    EXPECT_NEAR(library_frame(srt(5.2e-4f, 0)).transform(p).y, 0.52f, 0.01f);
    // The smallest shift beside it keeps the rotation.
    EXPECT_NEAR(library_frame(srt(4.8e-4f, 0, {1, 1, 1}, {1e-20f, 0, 0})).transform(p).y, 0.48f, 0.01f);
}

TEST(HiprtHazards, AZeroAxisWithAnAngleIsNotANumber) {
    kernels::FrameSrt frame = srt(0.5f, 0);
    frame.axis[2] = 0;
    EXPECT_TRUE(std::isnan(library_frame(frame).transform({1, 2, 3}).x));
    frame.angle = 0;
    EXPECT_EQ(library_frame(frame).transform({1, 2, 3}).x, 1.0f);
}

TEST(HiprtHazards, AScaleOfZeroHasNoInverse) {
    EXPECT_FALSE(std::isfinite(library_frame(srt(0.5f, 0, {1, 0, 1})).invTransform({1, 2, 3}).x +
                               library_frame(srt(0.5f, 0, {1, 0, 1})).invTransform({1, 2, 3}).y));
    const Library between = at_time({srt(0, 0, {1, -1, 1}), srt(0, 1)}, 0.5f);
    EXPECT_FALSE(std::isfinite(between.invTransform({1, 2, 3}).y));
}

TEST(HiprtHazards, MoreThanHalfATurnGoesTheShortWayRound) {
    // 0.75 turns from frame to frame: half-way is 0.375 turns, not -0.125.
    const float3 p = at_time({srt(0, 0), srt(0.75f * 2 * kPiF, 1)}, 0.5f).transform({1, 0, 0});
    EXPECT_NEAR(p.y, -std::sqrt(0.5f), 1e-5f);
}

/// Rotation about x after an uneven scale of the parent: sheared.
kernels::FrameMatrix sheared(float angle) {
    const float c = std::cos(angle), s = std::sin(angle);
    return {{{1, 0, 0, 0}, {0, 2 * c, -2 * s, 0}, {0, s, c, 0}}, 0, {}};
}

TEST(HiprtHazards, TheInverseUnderShearIsWrong) {
    const Library frame = library_frame(sheared(0.5f));
    const float3 p{0.3f, 0.4f, 0.5f};
    const float3 world = frame.transform(p);
    const float error = distance(frame.invTransform(world), p);
    EXPECT_GT(error, 0.01f);
    const kernels::FrameMatrix m = sheared(0.5f);
    EXPECT_NEAR(world.y, m.matrix[1][1] * p.y + m.matrix[1][2] * p.z, 1e-5f);  // the way out is right
}

TEST(HiprtHazards, NormalsUnderShearAreWrong) {
    const float c = std::cos(0.5f), s = std::sin(0.5f);
    const Library frame =
        library_frame(kernels::FrameMatrix{{{2 * c, -2 * s, 0, 0}, {s, c, 0, 0}, {0, 0, 1, 0}}, 0, {}});
    // The plane through two edges: its normal has to stay perpendicular to both.
    const float3 normal = frame.transformVector({1, -1, 0});
    float worst = 0;
    for (const float3& e : {frame.transform({1, 1, 0}), frame.transform({0, 0, 1})})
        worst = std::max(worst, std::abs(normal.x * e.x + normal.y * e.y + normal.z * e.z));
    EXPECT_GT(worst, 0.01f);
}

TEST(HiprtHazards, DirectionsLoseDigitsFarFromTheOrigin) {
    const std::vector<kernels::FrameSrt> frames{srt(0.3f, 0), srt(0.5f, 1)};
    const hiprt::Frame at = at_time(frames, 0.5f);
    const float3 direction{0.6f, 0.48f, 0.64f};
    const float3 exact = at.invTransformVector(direction);  // a rotation alone: no shear to spoil it
    float before = 0;
    for (const float far : {1e3f, 1e5f, 1e6f}) {
        float worst = 0;
        for (int i = 0; i < 100; ++i) {
            hiprtRay ray;
            ray.origin = {far + static_cast<float>(i), 0.7f * far, -0.3f * far};
            ray.direction = direction;
            const Frames both(frames);
            worst = std::max(worst, distance(both.transform().transformRay(ray, 0.5f).direction, exact));
        }
        EXPECT_GT(worst, 1e-8f * far);
        EXPECT_LT(worst, 2e-7f * far);
        EXPECT_GT(worst, before);
        before = worst;
    }
}

TEST(HiprtHazards, BoundsOfTurningThingsCutTheArc) {
    for (const float degrees : {10.0f, 90.0f, 170.0f}) {
        const float angle = degrees / 180 * kPiF;
        // A point whose way's highest place lies between two of the three samples of a step.
        const std::vector<kernels::FrameSrt> frames{srt(0, 0), srt(angle, 1)};
        const float eighth = angle / 8;
        const float3 p{std::sin(eighth), std::cos(eighth), 0};
        const hiprt::Aabb box = Frames(frames).transform().boundPointMotion(p);
        EXPECT_NEAR(1 - box.m_max.y, 1 - std::cos(eighth), 1e-5f) << degrees;
    }
    // What is left at 10 degrees a step, the most that we allow.
    EXPECT_LT(1 - std::cos(10.0f / 180 * kPiF / 8), 0.00024f);
}

TEST(HiprtHazards, ARayAlongAFaceMissesTheBoxesOnBothSides) {
    const hiprt::Aabb left({-1, -1, -1}, {0, 1, 1}), right({0, -1, -1}, {1, 1, 1});
    const auto meets = [](const hiprt::Aabb& box, float x) {
        const float3 direction{x, 0, 1}, inverse{1 / direction.x, 1 / direction.y, 1 / direction.z};
        const hiprtFloat2 t = box.intersect({0, 0.5f, -3}, inverse, 100.0f);
        return t.x <= t.y;
    };
    EXPECT_FALSE(meets(left, 0.0f) || meets(right, 0.0f));
    for (const float x : {1e-20f, -1e-20f}) EXPECT_TRUE(meets(left, x) || meets(right, x)) << x;
}

TEST(HiprtHazards, RaysAtASharedEdgePassBetweenTheTriangles) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(-1, 1);
    int missed = 0;
    constexpr int kRays = 20'000;
    for (int i = 0; i < kRays; ++i) {
        const float3 a{uniform(random), uniform(random), 0}, b{uniform(random), uniform(random), 0};
        const float3 across{-(b.y - a.y), b.x - a.x, 0};
        const float3 c{a.x + across.x, a.y + across.y, 0.3f}, d{a.x - across.x, a.y - across.y, 0.2f};
        const float at = 0.5f + 0.4f * uniform(random);
        const float3 target{a.x + (b.x - a.x) * at, a.y + (b.y - a.y) * at, 0};
        hiprtRay ray;
        ray.origin = {uniform(random), uniform(random), 3};
        ray.direction = {target.x - ray.origin.x, target.y - ray.origin.y, target.z - ray.origin.z};
        hiprtFloat2 uv;
        float t;
        const bool hit =
            hiprt::Triangle(a, b, c).intersect(ray, uv, t, 0) || hiprt::Triangle(b, a, d).intersect(ray, uv, t, 0);
        missed += hit ? 0 : 1;
    }
    // Not watertight: some slip through, so devices are compared statistically and never pixel by pixel.
    EXPECT_GT(missed, kRays / 100);
    RecordProperty("missed_percent", std::to_string(100.0 * missed / kRays));
}

}  // namespace
}  // namespace kadr::test
