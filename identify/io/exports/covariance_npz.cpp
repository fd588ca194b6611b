#include "volcal/identify/io/exports/covariance_npz.h"

#include "volcal/identify/io/exports/npz_archive.h"

namespace volcal {

std::string covariance_npz(const JointValues& parameters, const JointTable& table) {
  NpzArchive archive;
  archive.add("names", parameters.names);
  archive.add("units", parameters.units);
  archive.add("values", parameters.values);
  archive.add("covariance", parameters.covariance);
  archive.add("table_names", table.rows.names);
  archive.add("table_positions", table.positions);
  archive.add("table_position_units", table.position_units);
  archive.add("table_directions", table.directions);
  archive.add("table_extrapolated", table.extrapolated);
  archive.add("table_units", table.rows.units);
  archive.add("table_values", table.rows.values);
  archive.add("table_covariance", table.rows.covariance);
  return archive.bytes();
}

}  // namespace volcal
