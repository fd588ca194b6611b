// What a program of a third party does with the installed library: describe a machine and read its parts.

#include <iostream>

#include "volcal/model/description/machine.h"

int main() {
  volcal::Machine machine;
  machine.structure = volcal::Structure::parse("w X' b Y Z t");
  std::cout << "structure " << machine.structure.code << ", squareness";
  for (const auto& symbol : machine.datum.squareness()) std::cout << ' ' << symbol.name();
  std::cout << "\n";
  if (machine.structure.joints.size() != 3 || !machine.structure.joints.front().workpiece_side) return 1;
  std::cout << "consumer: volcal works\n";
  return 0;
}
