#include "shot/prices.h"

#include <fmt/format.h>

#include "shot/prices_measured.h"

namespace kadr {

namespace {

/// A choice that was built, measured and taken out again: no sample gets to the same error sooner than what is done instead
/// by more than runs differ by. How that was measured, and where it would have helped: CHANGELOG.md.
struct RefusedChoice {
    const char* what;
    const char* instead;
    double cost, most_cost, relmse, flip, most_flip;  ///< as in MeasuredPrice, over what is done instead
};
constexpr RefusedChoice kRefusedChoices[] = {
    {"rectangles by solid angle", "by area", 1.14, 1.23, 0.98, 0.99, 1.00},
    {"single scattering", "all orders", 1.01, 1.05, 1.00, 1.02, 8.25},
    {"textures as floats", "the file's bits", 1.08, 1.20, 1.00, 1.00, 1.00},
    {"textures as half floats", "the file's bits", 1.05, 1.11, 1.00, 1.00, 1.00},
};

constexpr const char* kColumns = "  {:<25} {:<27} {:>5} {:>7}  {:>6}  {:>5} {:>7}{}\n";

template <class Price>
std::string row_of(const char* key, const char* value, const Price& price, const std::string& changes) {
    const auto figure = [](double ratio) { return fmt::format("{:.{}f}", ratio, ratio < 100 ? 2 : 0); };
    return fmt::format(kColumns, key, value, figure(price.cost), figure(price.most_cost), figure(price.relmse), figure(price.flip),
                       figure(price.most_flip), changes);
}

std::string heading(const char* key, const char* value, const char* changes) {
    return fmt::format(kColumns, key, value, "time", "at most", "relMSE", "FLIP", "at most", changes);
}

std::string prices_text() {
    std::string text = heading("setting", "value", "  changes");
    for (const MeasuredPrice& price : kMeasuredPrices)
        text += row_of(price.key, price.value, price, price.changed > 0 ? fmt::format("  {} of {}", price.changed, kPriceShots) : "  none");
    return text;
}

std::string refused_text() {
    std::string text = "\n  built, measured, and not offered: no sample gets to the same error sooner by more than runs differ by\n\n" + heading("what", "instead of", "");
    for (const RefusedChoice& choice : kRefusedChoices) text += row_of(choice.what, choice.instead, choice, "");
    return text;
}

std::string shortcuts_text() {
    std::string text = "\n  ways to the same FLIP: processor time over that of equal samples for every pixel, median (least to most)\n\n";
    for (const MeasuredShortcut& way : kMeasuredShortcuts)
        text += fmt::format("  {:<22} {:>5.2f}  ({:.2f} to {:.2f})\n", way.way, way.median, way.least, way.most);
    return text;
}

}  // namespace

std::string describe_prices() {
    return fmt::format("prices\n"
                       "  what a setting of `render` costs and loses: processor time of a frame, relMSE and FLIP over those with the shot's own settings, at\n"
                       "  {} samples a pixel; medians of the samples whose picture it changes, and the most of all {} (tools/bench/prices.py).\n"
                       "  fresnel: exact and the shot's own settings are both compared with exact pictures\n\n",
                       kPriceSamples, kPriceShots) +
           prices_text() + shortcuts_text() + refused_text();
}

}  // namespace kadr
