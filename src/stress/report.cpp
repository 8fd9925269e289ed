#include "stress/report.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stress/file.h"

namespace kadr::stress {
namespace {

/// A figure of a cell, and from where to where it is coloured: green at `good`, red at `bad`, on a logarithmic scale.
struct Column {
    const char* name;
    const char* title;
    std::optional<double> (*value)(const CellResult&);
    double good, bad;
};

template <class Figures, class Value>
std::optional<double> of(const std::optional<Figures>& figures, Value value) {
    return figures ? std::optional<double>(static_cast<double>(value(*figures))) : std::nullopt;
}

constexpr double kSteps = 255;

const std::vector<Column>& columns() {
    static const std::vector<Column> all{
        {"image_error", "mean error of the picture, in steps of eight bits", [](const CellResult& r) { return of(r.picture, [](const auto& p) { return kSteps * p.mean; }); }, 1e-3, 1},
        {"largest_error", "largest error of a pixel, in steps", [](const CellResult& r) { return of(r.picture, [](const auto& p) { return kSteps * p.largest; }); }, 1, 256},
        {"pixels_beyond", "share of pixels off by more than a step", [](const CellResult& r) { return of(r.picture, [](const auto& p) { return p.beyond; }); }, 1e-3, 1},
        {"holes", "camera rays that pass through surfaces, or meet what is not there", [](const CellResult& r) { return of(r.rays, [](const auto& f) { return f.holes; }); }, 0.5, 100},
        {"wrong_surfaces", "camera rays that meet another material than is in front", [](const CellResult& r) { return of(r.rays, [](const auto& f) { return f.wrong_surfaces; }); }, 0.5, 100},
        {"false_shadows", "shadow rays that meet what is not there", [](const CellResult& r) { return of(r.rays, [](const auto& f) { return f.false_shadows; }); }, 0.5, 100},
        {"leaks", "shadow rays that pass through surfaces", [](const CellResult& r) { return of(r.rays, [](const auto& f) { return f.leaks; }); }, 0.5, 100},
        {"hit_error_px", "largest error of a point that was met, pixels", [](const CellResult& r) { return of(r.rays, [](const auto& f) { return f.position_error_px; }); }, 1e-3, 1},
        {"hit_error_ulp", "the same in units in the last place of its coordinates", [](const CellResult& r) { return of(r.rays, [](const auto& f) { return f.position_error_ulp; }); }, 1e2, 1e6},
        {"drift", "mean difference of the reference from that of the ordinary value, in steps", [](const CellResult& r) { return of(r.drift, [](const auto& p) { return kSteps * p.mean; }); }, 1e-3, 1},
        {"dropped_samples", "samples that were not finite", [](const CellResult& r) { return std::optional<double>(static_cast<double>(r.dropped_samples)); }, 0.5, 100},
        {"not_finite", "values of the picture that are not finite", [](const CellResult& r) { return std::optional<double>(static_cast<double>(r.not_finite)); }, 0.5, 2},
    };
    return all;
}

std::string escaped(std::string_view text) {
    std::string safe;
    for (const char c : text) safe += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
    return safe;
}

/// From green (120 degrees of hue) to red (0).
std::string color_of(const Column& column, double value) {
    const double at = value <= column.good ? 0 : std::clamp(std::log(value / column.good) / std::log(column.bad / column.good), 0.0, 1.0);
    return fmt::format("hsl({:.0f} 65% 80%)", 120 * (1 - at));
}

std::string html_cell(const Column& column, const CellResult& result) {
    const std::optional<double> value = column.value(result);
    if (!value) return "<td></td>";
    return fmt::format("<td style=\"background:{}\">{:.3g}</td>", color_of(column, *value), *value);
}

std::string html_row(const CellResult& result) {
    std::string row = fmt::format("<tr><th class=\"{}\">{}</th>", result.sound() ? "ok" : result.fault() ? "bad" : "beyond", escaped(name_of(result.cell)));
    if (!result.refused.empty())
        row += fmt::format("<td class=\"note\" colspan=\"{}\">{}{}</td>", columns().size(), result.refusal_expected ? "refused: " : "refused, which the sweep did not expect: ", escaped(result.refused));
    else
        for (const Column& column : columns()) row += html_cell(column, result);
    std::string warnings;
    for (const std::string& warning : result.warnings) warnings += fmt::format("<div>{}</div>", escaped(warning));
    return row + fmt::format("<td class=\"note\">{}</td></tr>\n", warnings);
}

std::string html_head() {
    std::string head;
    for (const Column& column : columns()) head += fmt::format("<th title=\"{}\">{}</th>", escaped(column.title), column.name);
    return "<tr><th>cell</th>" + head + "<th>said before rendering</th></tr>\n";
}

std::string html_ranges(const std::vector<CellResult>& results) {
    std::string rows;
    for (const SafeRange& range : safe_ranges(results))
        rows += fmt::format("<tr><th class=\"{}\">{}</th><td class=\"note\">{}</td><td class=\"note\">{}</td></tr>\n", range.complete ? "ok" : "beyond", escaped(range.axis->name), escaped(range.text()),
                            escaped(range.axis->meaning));
    return "<table><tr><th>axis</th><th>safe</th><th>what it is</th></tr>\n" + rows + "</table>\n";
}

std::string html_page(const std::vector<CellResult>& results) {
    const RayFigures rays = total_rays(results);
    const auto bad = std::count_if(results.begin(), results.end(), [](const CellResult& r) { return !r.sound(); });
    std::string page = "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>kadr stress</title><style>\n"
                       "body{font:14px system-ui,sans-serif;margin:2em;color:#222}table{border-collapse:collapse;margin:1em 0}\n"
                       "th,td{padding:2px 8px;text-align:right;border:1px solid #ddd}th:first-child,td.note{text-align:left}\n"
                       "th.ok{background:#e2f3e2}th.bad{background:#f2a9a9}th.beyond{background:#f6e7c8}td.note{min-width:12em;max-width:46em;color:#555}th{vertical-align:top}\n"
                       "</style></head><body><h1>kadr stress</h1>\n";
    page += fmt::format("<p>{} cells, {} not sound. {} camera rays, {} shadow rays and {} rays to lights against the reference in double: {} holes, {} wrong surfaces, {} false shadows, {} leaks. "
                        "A cell is sound where its picture is within a step of eight bits of the reference on average, no ray contradicts it and no sample is lost.</p>\n",
                        results.size(), bad, rays.camera_rays, rays.shadow_rays, rays.light_rays, rays.holes, rays.wrong_surfaces, rays.false_shadows, rays.leaks);
    page += "<h2>Safe ranges</h2>\n" + html_ranges(results) + "<h2>Cells</h2>\n<table>\n" + html_head();
    for (const CellResult& result : results) page += html_row(result);
    return page + "</table></body></html>\n";
}

nlohmann::ordered_json object_of(const CellResult& result) {
    nlohmann::ordered_json json{{"cell", name_of(result.cell)}, {"axis", result.cell.axis->name}, {"value", result.cell.value}, {"shot", result.shot.filename().string()}};
    json["ordinary"] = result.cell.axis->ordinary;
    json["same_picture"] = result.cell.axis->same_picture;
    if (result.cell.second) json["second"] = result.cell.second->name, json["second_value"] = result.cell.second_value;
    json["sound"] = result.sound();
    json["stated_safe"] = is_safe(result.cell);
    if (!result.refused.empty()) json["refused"] = result.refused;
    else
        for (const Column& column : columns())
            if (const std::optional<double> value = column.value(result)) json[column.name] = *value;
    if (result.rays) json["camera_rays"] = result.rays->camera_rays, json["shadow_rays"] = result.rays->shadow_rays, json["light_rays"] = result.rays->light_rays;
    if (!result.warnings.empty()) json["warnings"] = result.warnings;
    json["seconds"] = result.seconds;
    return json;
}

std::string csv_of(const std::vector<CellResult>& results) {
    std::string text = "cell,axis,value,second,second_value,sound";
    for (const Column& column : columns()) text += fmt::format(",{}", column.name);
    text += "\n";
    for (const CellResult& r : results) {
        text += fmt::format("{},{},{},{},{},{}", name_of(r.cell), r.cell.axis->name, r.cell.value, r.cell.second ? r.cell.second->name : "",
                            r.cell.second ? fmt::format("{}", r.cell.second_value) : "", r.sound() ? 1 : 0);
        for (const Column& column : columns()) {
            const std::optional<double> value = r.refused.empty() ? column.value(r) : std::nullopt;
            text += value ? fmt::format(",{}", *value) : ",";
        }
        text += "\n";
    }
    return text;
}

}  // namespace

std::string SafeRange::text() const {
    if (none) return "none";
    const std::string unit = axis->unit.empty() ? "" : fmt::format(" {}", axis->unit);
    return low == high ? fmt::format("{:g}{}", low, unit) : fmt::format("{:g} to {:g}{}", low, high, unit);
}

std::vector<SafeRange> safe_ranges(const std::vector<CellResult>& results) {
    std::vector<SafeRange> ranges;
    for (auto first = results.begin(); first != results.end();) {
        const Axis* axis = first->cell.axis;
        const auto last = std::find_if(first, results.end(), [&](const CellResult& r) { return r.cell.axis != axis || r.cell.second; });
        if (first->cell.second) {
            ++first;
            continue;
        }
        const auto ordinary = std::find_if(first, last, [&](const CellResult& r) { return r.cell.value == axis->ordinary; });
        SafeRange range{axis, axis->ordinary, axis->ordinary, std::all_of(first, last, [](const CellResult& r) { return r.sound(); }), ordinary == last || !ordinary->sound()};
        if (!range.none) {
            for (auto at = ordinary; at != last && at->sound(); ++at) range.high = at->cell.value;
            for (auto at = ordinary; at->sound(); --at) {
                range.low = at->cell.value;
                if (at == first) break;
            }
        }
        ranges.push_back(range);
        first = last;
    }
    return ranges;
}

RayFigures total_rays(const std::vector<CellResult>& results) {
    RayFigures sum;
    for (const CellResult& result : results)
        if (result.rays) sum = sum + *result.rays;
    return sum;
}

std::string json_of(const CellResult& result) { return object_of(result).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace); }

std::filesystem::path write_report(const std::vector<CellResult>& results, const std::filesystem::path& folder) {
    nlohmann::ordered_json cells = nlohmann::ordered_json::array();
    for (const CellResult& result : results) cells.push_back(object_of(result));
    write_file(folder / "report.json", cells.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
    write_file(folder / "report.csv", csv_of(results));
    write_file(folder / "report.html", html_page(results));
    return folder / "report.html";
}

}  // namespace kadr::stress
