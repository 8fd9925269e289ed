#include "base/error.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace kadr {
namespace {

// Filled in member by member: GCC 12 warns wrongly (maybe-uninitialized) about temporaries of this aggregate.
std::string text_of(SourceLocation where, std::string found, std::string excerpt = {}, int length = 1,
                    std::string expected = {}, bool warning = false) {
    Diagnostic diagnostic;
    diagnostic.where = std::move(where);
    diagnostic.found = std::move(found);
    diagnostic.excerpt = std::move(excerpt);
    diagnostic.excerpt_length = length;
    diagnostic.expected = std::move(expected);
    diagnostic.warning = warning;
    return diagnostic.text();
}

TEST(Diagnostic, ReadsLikeTheExampleInTheStyleGuide) {
    EXPECT_EQ(text_of({"shots/pan.yaml", 14, 19}, "shutter.angle is 540 deg", "shutter: { angle: 540 deg }", 7,
                      "expected 0 to 360 deg; use 360 deg to keep the shutter open for the whole frame"),
              "shots/pan.yaml:14:19: error: shutter.angle is 540 deg\n"
              "    shutter: { angle: 540 deg }\n"
              "                      ^~~~~~~\n"
              "  expected 0 to 360 deg; use 360 deg to keep the shutter open for the whole frame");
}

TEST(Diagnostic, WithoutAPlaceIsTheFindingAlone) {
    EXPECT_EQ(text_of({}, "no such frame", {}, 1, "expected 0 to 95"), "error: no such frame\n  expected 0 to 95");
    EXPECT_EQ(text_of({}, "no such frame"), "error: no such frame");
}

TEST(Diagnostic, WarningsSaySo) {
    EXPECT_EQ(text_of({"a.yaml", 0, 0}, "it will be black", {}, 1, {}, true), "a.yaml: warning: it will be black");
}

TEST(Diagnostic, ShowsPathsBelowTheWorkingFolderRelativeToIt) {
    const auto here = std::filesystem::current_path();
    EXPECT_EQ(text_of({(here / "shots/a.yaml").string(), 1, 2}, "x"), "shots/a.yaml:1:2: error: x");
    EXPECT_EQ(text_of({"/elsewhere/a.yaml", 1, 2}, "x"), "/elsewhere/a.yaml:1:2: error: x");
}

TEST(Diagnostic, CaretStaysBelowItsColumnAfterTabsAndWideText) {
    EXPECT_EQ(text_of({"a", 1, 3}, "x", "\tab", 1), "a:1:3: error: x\n    \tab\n    \t ^");
    EXPECT_EQ(text_of({"a", 1, 3}, "x", "é: 1", 9), "a:1:3: error: x\n    é: 1\n      ^~");
}

TEST(Diagnostic, LongLinesAreShownAroundTheCaret) {
    const std::string text = text_of({"a", 1, 501}, "x", std::string(500, 'a') + "B" + std::string(500, 'c'));
    EXPECT_LT(text.size(), 400u);
    EXPECT_NE(text.find("..." + std::string(60, 'a') + "Bccc"), std::string::npos);
    EXPECT_NE(text.find("\n    " + std::string(63, ' ') + "^"), std::string::npos);
}

TEST(InputError, WhatHoldsEveryProblem) {
    std::vector<Diagnostic> both(2);
    both[0].found = "one";
    both[1].found = "two";
    const InputError error(both);
    EXPECT_STREQ(error.what(), "error: one\nerror: two");
    EXPECT_EQ(error.diagnostics().size(), 2u);
}

}  // namespace
}  // namespace kadr
