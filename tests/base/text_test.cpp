#include "base/text.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdlib>

namespace kadr {
namespace {

TEST(NearestName, FindsTypingErrors) {
    const std::vector<std::string> names{"focal_length", "f_stop", "focus", "up"};
    EXPECT_EQ(nearest_name("focal_lenght", names), "focal_length");  // a swap counts one
    EXPECT_EQ(nearest_name("fstop", names), "f_stop");
    EXPECT_EQ(nearest_name("ub", names), "up");  // one edit is always allowed
    EXPECT_EQ(nearest_name("shutter", names), std::nullopt);
    EXPECT_EQ(nearest_name("x", {}), std::nullopt);
    EXPECT_EQ(nearest_name(std::string(100000, 'f'), names), std::nullopt);
}

TEST(FormatNumber, IsTheShortestText) {
    EXPECT_EQ(format_number(0.1), "0.1");
    EXPECT_EQ(format_number(24), "24");
    EXPECT_EQ(format_number(100000), "100000");
    EXPECT_EQ(format_number(1e20), "1e+20");
    EXPECT_EQ(format_number(-0.0), "0");
}

RC_GTEST_PROP(FormatNumber, ReadsBackAsTheSameDouble, (double value)) {
    RC_PRE(std::isfinite(value));
    RC_ASSERT(std::strtod(format_number(value).c_str(), nullptr) == value);
}

TEST(Utf8, AcceptsWellFormedTextAlone) {
    EXPECT_EQ(first_invalid_utf8("plain, \xC3\xA9, \xE2\x82\xAC, \xF0\x9F\x98\x80"), std::nullopt);
    EXPECT_EQ(first_invalid_utf8("ab\xFF"), 2u);
    EXPECT_EQ(first_invalid_utf8("\xC0\xAF"), 0u);           // overlong
    EXPECT_EQ(first_invalid_utf8("a\xED\xA0\x80"), 1u);      // surrogate
    EXPECT_EQ(first_invalid_utf8("a\xF4\x90\x80\x80"), 1u);  // beyond U+10FFFF
    EXPECT_EQ(first_invalid_utf8("ab\xE2\x82"), 2u);         // cut short
}

}  // namespace
}  // namespace kadr
