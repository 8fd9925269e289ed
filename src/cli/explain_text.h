#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "render/explain.h"

namespace kadr {

/// What `kadr explain` prints for a person.
std::string explanation_text(const Explanation& explanation);
/// The same facts.
nlohmann::ordered_json explanation_json(const Explanation& explanation);

}  // namespace kadr
