#pragma once
/// A table format of the consumer's own: one file per linear axis, position and correction of that axis.

#include <memory>

#include "volcal/identify/compensation/table_format.h"

std::unique_ptr<const volcal::TableFormat> lines_format();
