// Kernels compiled for what a frame needs: the same pixels as those of the kernel that can do everything.
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "base/error.h"
#include "device/embree/embree_device.h"
#include "device/embree/kernel_sets.h"
#include "device/random_scene.h"
#include "device/requirement_names.h"
#include "device/same_picture.h"

namespace kadr::test {
namespace {

using kernels::IntegratorKind;

SmallScene::Result render(SmallScene& s, int width, KernelChoice kernels) {
    FilmLayers layers;
    layers.albedo = layers.normal = layers.depth = layers.samples = true;
    layers.motion = s.snapshot.previous.has_value();
    return s.render(6, 1, width, layers, kernels);
}

/// No tolerance: what a kernel leaves out, another computes without effect. @return the set of the smaller kernel
unsigned expect_same(SmallScene& s, int width, const std::string& name) {
    const SmallScene::Result needed = render(s, width, KernelChoice::needed), all = render(s, width, KernelChoice::all);
    EXPECT_TRUE(same_bits(needed.image, all.image)) << name << ", " << width << " lanes, set " << needed.statistics.compiled;
    EXPECT_EQ(needed.statistics.rays, all.statistics.rays) << name;
    EXPECT_EQ(all.statistics.compiled, compiled_set(s.snapshot.settings.integrator, kernels::requirement::kAll)) << name;
    return needed.statistics.compiled;
}

std::set<unsigned> compiled_sets(IntegratorKind integrator) {
    using namespace kernel_sets;
    if (integrator == IntegratorKind::direct) return {kDirect.begin(), kDirect.end()};
    std::set<unsigned> sets(kPlainPath.begin(), kPlainPath.end());
    sets.insert(kMapsPath.begin(), kMapsPath.end());
    return sets;
}

class KernelSets : public testing::TestWithParam<std::tuple<IntegratorKind, int>> {
protected:
    void SetUp() override {
        if (width() > best_width()) GTEST_SKIP() << "this processor has no AVX2";
    }
    IntegratorKind integrator() const { return std::get<0>(GetParam()); }
    int width() const { return std::get<1>(GetParam()); }
};

TEST_P(KernelSets, LeaveTheSamePixelsAsTheLargestOne) {
    for (const VariedScene& content : varied_scenes()) {
        SmallScene s = sunlit(integrator());
        content.add(s);
        expect_same(s, width(), content.name);
    }
}

TEST_P(KernelSets, LeaveTheSamePixelsInScenesOfRandomFeatures) {
    constexpr unsigned kScenes = 300;
    std::set<unsigned> used;
    for (unsigned seed = 1; seed <= kScenes; ++seed) {
        RandomScene random(seed, integrator());
        used.insert(expect_same(random.scene, width(), "seed " + std::to_string(seed) + ": " + random.description()));
    }
    EXPECT_EQ(used, compiled_sets(integrator())) << "a kernel was compared with itself alone, or not at all";
}

INSTANTIATE_TEST_SUITE_P(BothIntegratorsAndWidths, KernelSets,
                         testing::Combine(testing::Values(IntegratorKind::path, IntegratorKind::direct), testing::Values(1, 8)));

TEST(CompiledSet, HoldsWhatIsNeededAndAsLittleMoreAsThereIs) {
    using namespace kernels::requirement;
    for (const IntegratorKind integrator : {IntegratorKind::path, IntegratorKind::direct})
        for (unsigned all_bits = 0; all_bits <= kAll; ++all_bits) {
            const unsigned needs = integrator == IntegratorKind::direct ? all_bits & ~(kEmitters | kMirrors) : all_bits;
            const unsigned taken = compiled_set(integrator, all_bits);
            EXPECT_EQ(taken & needs, needs) << needs;
            for (const unsigned other : compiled_sets(integrator))
                EXPECT_FALSE((other & needs) == needs && other != taken && (other & ~taken) == 0) << needs << ": " << other << " instead of " << taken;
        }
}

TEST(CompiledSet, IsMadeInBothWidths) {
    for (const IntegratorKind integrator : {IntegratorKind::path, IntegratorKind::direct})
        for (const unsigned set : compiled_sets(integrator))
            for (int width = 1; width <= best_width(); width += 7)
                EXPECT_TRUE(make_tile_driver(width, integrator, set)) << set << ", " << width << " lanes";
}

TEST(RequirementNames, NameEveryRequirementOnce) {
    unsigned named = 0;
    for (const RequirementName& requirement : kRequirementNames) {
        EXPECT_EQ(named & requirement.bit, 0u) << requirement.name;
        named |= requirement.bit;
    }
    EXPECT_EQ(named, kernels::requirement::kAll);
    EXPECT_EQ(names_of_requirements(kernels::requirement::kMaps | kernels::requirement::kEmitters), "maps emitters");
    EXPECT_EQ(names_of_requirements(0), "nothing");
}

/// Sets KADR_KERNEL_SET while it lives.
class KernelSetVariable {
public:
    explicit KernelSetVariable(const char* value) { setenv("KADR_KERNEL_SET", value, 1); }
    ~KernelSetVariable() { unsetenv("KADR_KERNEL_SET"); }
};

unsigned set_taken() {
    SmallScene s = sunlit(IntegratorKind::path);
    return s.render(1, 1, 1, {}, KernelChoice::by_environment).statistics.compiled;
}

TEST(KernelSetVariable, ChoosesTheKernels) {
    const unsigned all = compiled_set(IntegratorKind::path, kernels::requirement::kAll);
    EXPECT_EQ(set_taken(), 0u);
    {
        const KernelSetVariable variable("all");
        EXPECT_EQ(set_taken(), all);
    }
    const KernelSetVariable variable("needed");
    EXPECT_EQ(set_taken(), 0u);
}

TEST(KernelSetVariable, OtherValuesAreErrors) {
    const KernelSetVariable variable("most");
    try {
        make_device({"cpu", 1, 1});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_EQ(error.diagnostics().front().found, "KADR_KERNEL_SET is 'most'");
        EXPECT_EQ(error.diagnostics().front().expected,
                  "expected needed (the kernels that a frame can do with) or all (those that can render anything)");
    }
}

}  // namespace
}  // namespace kadr::test
