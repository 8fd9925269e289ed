#include "frame/clip_offsets.h"

#include <algorithm>

namespace kadr {

ClipOffsets clip_offsets_of(const std::vector<std::vector<Placement>>& copies) {
    ClipOffsets all;
    for (const std::vector<Placement>& of_entry : copies) {
        std::vector<double>& offsets = all.emplace_back();
        for (const Placement& copy : of_entry) offsets.push_back(copy.clip_offset_s);
        if (offsets.empty()) offsets.push_back(0);
        std::sort(offsets.begin(), offsets.end());
        offsets.erase(std::unique(offsets.begin(), offsets.end()), offsets.end());
        offsets.shrink_to_fit();
    }
    return all;
}

}  // namespace kadr
