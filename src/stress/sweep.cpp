#include "stress/sweep.h"

#include "render/render_job.h"

namespace kadr::stress {
namespace {

/// Rays by the million for the whole sweep; by the hundred thousand where it has to be quick.
RayCounts ray_counts(bool quick) { return quick ? RayCounts{1, 4} : RayCounts{2, 16}; }

}  // namespace

std::vector<Cell> cells_to_run(const StressOptions& options) {
    std::vector<const Axis*> chosen;
    for (const std::string& name : options.axes) chosen.push_back(&axis_of(name));
    if (options.axes.empty())
        for (const Axis& axis : axes()) chosen.push_back(&axis);
    std::vector<Cell> cells;
    for (const Axis* axis : chosen)
        for (const Cell& cell : cells_of(*axis, options.quick)) cells.push_back(cell);
    if (options.axes.empty())
        for (const Cell& cell : pair_cells(options.quick)) cells.push_back(cell);
    return cells;
}

std::vector<CellResult> run_sweep(const StressOptions& options, const std::function<void(const CellResult&, std::size_t, std::size_t)>& done) {
    const std::vector<Cell> cells = cells_to_run(options);
    Evaluator evaluator({options.device, ray_counts(options.quick)}, options.output);
    std::vector<CellResult> results;
    for (const Cell& cell : cells) {
        if (interrupt_requested()) throw Interrupted();
        results.push_back(evaluator.evaluate(cell));
        done(results.back(), results.size(), cells.size());
    }
    return results;
}

}  // namespace kadr::stress
