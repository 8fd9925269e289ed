#include "device/requirement_names.h"

namespace kadr {

std::string names_of_requirements(unsigned set) {
    std::string text;
    for (const RequirementName& requirement : kRequirementNames)
        if ((set & requirement.bit) != 0) text += (text.empty() ? "" : " ") + std::string(requirement.name);
    return text.empty() ? "nothing" : text;
}

}  // namespace kadr
