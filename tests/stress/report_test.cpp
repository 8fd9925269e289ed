// What the report's file says to programs that read it.
#include "stress/report.h"

#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "render/tiny_shot.h"

namespace kadr::stress {
namespace {

nlohmann::json cells_of_report(const std::vector<CellResult>& results) {
    const TemporaryFolder folder;
    write_report(results, folder.path());
    std::ifstream stream(folder.path() / "report.json");
    return nlohmann::json::parse(stream);
}

CellResult result_of(const Cell& cell) {
    CellResult result;
    result.cell = cell;
    result.shot = name_of(cell) + ".yaml";
    return result;
}

TEST(Report, SaysWhatTheValueIsHeldAgainst) {
    const nlohmann::json cells = cells_of_report({result_of({&axis_of("scale"), 1e9}), result_of({&axis_of("spin"), 1e3})});
    EXPECT_EQ(cells[0]["cell"], "scale_1000000000");
    EXPECT_EQ(cells[0]["ordinary"], 1);
    EXPECT_EQ(cells[0]["same_picture"], true);
    EXPECT_EQ(cells[1]["ordinary"], 0);
    EXPECT_EQ(cells[1]["same_picture"], false);
}

}  // namespace
}  // namespace kadr::stress
