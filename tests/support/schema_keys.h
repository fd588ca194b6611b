#pragma once
/// Keys of schemas.

#include <algorithm>
#include <string>

#include "volcal/model/description/schema.h"

namespace volcal::testing_support {

template <class Schema>
bool has_key(const Schema& schema, const std::string& key) {
  return std::ranges::find(schema.keys, key, &KeySchema::key) != schema.keys.end();
}

}  // namespace volcal::testing_support
