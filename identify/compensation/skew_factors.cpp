#include "volcal/identify/compensation/skew_factors.h"

namespace volcal {

SkewFactors skew_factors(const FitResult& result, const TableFormatOptions& options) {
  const Compensation ideal = ideal_compensation(result, options);
  SkewFactors factors;
  factors.xy = ideal.squareness(AxisName::X, AxisName::Y);
  factors.yz = ideal.squareness(AxisName::Y, AxisName::Z);
  factors.xz = ideal.squareness(AxisName::X, AxisName::Z) + factors.xy * factors.yz;
  return factors;
}

CompensationTables skew_tables(const SkewFactors& factors) {
  CompensationTables tables;
  tables.terms.emplace_back([factors](const AxisPosition& at, const ApproachDirection& /*direction*/) {
    const double y = at[index_of(AxisName::Y)], z = at[index_of(AxisName::Z)];
    Correction correction;
    correction.linear = {-y * factors.xy - z * (factors.xz - factors.xy * factors.yz), -z * factors.yz, 0.0};
    return correction;
  });
  return tables;
}

}  // namespace volcal
