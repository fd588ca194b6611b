#include "volcal/model/description/parallel_axes.h"

#include "volcal/model/description/errors.h"

namespace volcal {

void require_no_parallel_axes(const Machine& machine, const std::string& what, const std::string& remedy) {
  const std::vector<AxisName> axes = machine.parallel_axes();
  if (axes.empty()) return;
  const std::string letters = letters_of(axes);
  const std::string noun = axes.size() == 1 ? "the parallel axis " : "the parallel axes ";
  throw InputError({machine.file, 0}, what + " cannot take " + noun + letters + " of this machine",
                   remedy.empty() ? "leave " + letters +
                                        " out of the structure and of [axes] where it stands still: its "
                                        "position is then part of the tools' offsets"
                                  : remedy);
}

}  // namespace volcal
