#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace kadr {

/// A step of the quality ladder: values of the `render` section under one name, `render.quality` or `--quality`.
///
/// A step says how much work the same picture gets, not what it shows: the integrator, the filter, the view and the clamps
/// of draft, preview and final are the shot's.
struct QualityBlock {
    std::string_view name;
    std::string_view purpose;
    std::span<const std::pair<const char*, const char*>> values;  ///< keys of `render` and their values, in YAML
    std::string yaml() const;                                     ///< "{ samples: 16, bounces: 3 }"
};

/// draft, preview, final, reference: each costs more than the one before it, and errs less.
std::span<const QualityBlock> quality_blocks();

/// @return null where there is none of that name
const QualityBlock* find_quality(std::string_view name);

/// The ladder as `kadr describe quality` prints it: the blocks, what each is for, and what each was measured to cost and to
/// lose on the sample shots.
std::string describe_quality();

}  // namespace kadr
