// The shots of every axis: ordinary input, all of them different.
#include "stress/axis.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>

#include "base/error.h"
#include "frame/snapshot.h"
#include "render/loaded_shot.h"
#include "render/render_job.h"
#include "render/tiny_shot.h"

namespace kadr::stress {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// Cells whose files take long to write: they are as the smaller ones, only more.
bool is_large(const Cell& cell) { return cell.axis->name == "coincident" && cell.value > 1e5; }

std::vector<Cell> every_cell() {
    std::vector<Cell> cells = pair_cells(false);
    for (const Axis& axis : axes()) {
        std::ranges::copy(cells_of(axis, false), std::back_inserter(cells));
        std::ranges::copy(cells_of(axis, true), std::back_inserter(cells));
    }
    std::erase_if(cells, is_large);
    return cells;
}

std::string content_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// Everything that the files of a cell say, but for their own name.
std::string content_of(const std::filesystem::path& folder, const std::string& name) {
    std::string all;
    for (const char* ending : {".yaml", ".gltf", ".bin", ".hdr"}) all += content_of(folder / (name + ending));
    for (std::size_t at; (at = all.find(name)) != std::string::npos;) all.erase(at, name.size());
    return all;
}

TEST(Axes, ValuesAscendAndTheQuickOnesIncludeAnOrdinaryOne) {
    for (const Axis& axis : axes()) {
        EXPECT_TRUE(std::ranges::is_sorted(axis.values, std::ranges::less_equal()) && std::ranges::is_sorted(axis.quick)) << axis.name;
        EXPECT_THAT(axis.values, Contains(axis.ordinary)) << axis.name;
        EXPECT_THAT(axis.quick, Contains(axis.ordinary)) << axis.name;
        EXPECT_FALSE(axis.meaning.empty()) << axis.name;
    }
}

TEST(Axes, AreFoundByName) {
    EXPECT_EQ(axis_of("spin").unit, "deg/s");
    try {
        axis_of("distanse");
        FAIL() << "there is no such axis";
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "error: there is no axis 'distanse'\n  did you mean distance?");
    }
}

TEST(Axes, CellsAreNamedByTheirValues) {
    EXPECT_EQ(name_of(Cell{&axis_of("distance"), 1e4}), "distance_10000");
    EXPECT_EQ(name_of(Cell{&axis_of("distance"), 1e4, &axis_of("spin"), 1e30}), "distance_10000_spin_1e+30");
}

/// What stops the shot before its first ray; "" where nothing does.
std::string errors_of(const std::filesystem::path& shot) {
    try {
        check_shot(shot, {});
        const LoadedShot loaded(parse_shot(shot));
        make_snapshots(loaded.bound(), loaded.bound().sequence().frame(loaded.bound().timing().frames.front()));
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

TEST(Axes, EveryCellIsFitToRenderOrIsRefusedAsItSays) {
    const TemporaryFolder folder;
    for (const Cell& cell : every_cell()) {
        const std::string errors = errors_of(write_shot(cell, folder.path())), expected(refusal_of(cell));
        if (errors.find("and this machine has") != std::string::npos) continue;  // what a machine has memory for is not the sweep's to say
        if (expected.empty()) EXPECT_EQ(errors, "") << name_of(cell);
        else EXPECT_THAT(errors, HasSubstr(expected)) << name_of(cell);
    }
}

TEST(Axes, NoTwoCellsOfAnAxisAreTheSameShot) {
    const TemporaryFolder folder;
    for (const Axis& axis : axes()) {
        std::map<std::string, std::string> names;
        for (const Cell& cell : cells_of(axis, false)) {
            if (is_large(cell)) continue;
            write_shot(cell, folder.path());
            const auto [place, added] = names.emplace(content_of(folder.path(), name_of(cell)), name_of(cell));
            EXPECT_TRUE(added) << name_of(cell) << " is " << place->second;
        }
    }
}

}  // namespace
}  // namespace kadr::stress
