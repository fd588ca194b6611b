#pragma once
/// NumPy's .npz: an uncompressed zip of arrays in the format .npy, version 1.0, that `numpy.load` reads.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace volcal {

class NpzArchive {
 public:
  void add(const std::string& name, const Eigen::VectorXd& values);
  void add(const std::string& name, const Eigen::MatrixXd& values);
  void add(const std::string& name, const std::vector<std::int64_t>& values);
  void add(const std::string& name, const std::vector<bool>& values);
  /// Texts in UTF-8.
  void add(const std::string& name, const std::vector<std::string>& texts);

  /// The archive; the same arrays make the same bytes. Throws std::runtime_error.
  std::string bytes() const;

 private:
  void add_array(const std::string& name, const std::string& type, const std::string& shape,
                 std::span<const char> data);

  std::vector<std::pair<std::string, std::string>> files_;
};

}  // namespace volcal
