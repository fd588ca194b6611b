// Arrays of NumPy's .npz, byte by byte as the description of the format has them.

#include "volcal/identify/io/exports/npz_archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>

namespace volcal {
namespace {

using ::testing::ElementsAre;

/// What stands behind the local header of the first file of a zip; nothing is compressed.
std::string first_file(const std::string& zip) {
  const auto field = [&zip](std::size_t at) {
    return static_cast<std::size_t>(static_cast<unsigned char>(zip[at])) +
           256U * static_cast<unsigned char>(zip[at + 1]);
  };
  EXPECT_EQ(zip.substr(0, 4), "PK\x03\x04");
  EXPECT_EQ(field(8), 0U) << "stored";
  return zip.substr(30 + field(26) + field(28), field(22));
}

std::string header_of(const std::string& npy) {
  EXPECT_EQ(npy.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t length = static_cast<unsigned char>(npy[8]) + 256U * static_cast<unsigned char>(npy[9]);
  EXPECT_EQ((10 + length) % 64, 0U);
  EXPECT_EQ(npy[9 + length], '\n');
  return npy.substr(10, npy.find_last_not_of(" \n", 9 + length) - 9);
}

std::string data_of(const std::string& npy) { return npy.substr(npy.find('\n') + 1); }

TEST(NpzArchive, WritesAMatrixColumnByColumn) {
  NpzArchive archive;
  archive.add("m", (Eigen::MatrixXd(2, 3) << 1, 2, 3, 4, 5, 6).finished());
  const std::string npy = first_file(archive.bytes());
  EXPECT_EQ(header_of(npy), "{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }");
  std::array<double, 6> values{};
  ASSERT_EQ(data_of(npy).size(), sizeof values);
  std::memcpy(values.data(), data_of(npy).data(), sizeof values);
  EXPECT_THAT(values, ElementsAre(1, 4, 2, 5, 3, 6));
}

TEST(NpzArchive, WritesTextsOfAnyLanguageAsUtf32) {
  NpzArchive archive;
  archive.add("t", std::vector<std::string>{"a", "\xC2\xB5m", "\xF0\x9D\x84\x9E"});
  const std::string npy = first_file(archive.bytes());
  EXPECT_EQ(header_of(npy), "{'descr': '<U2', 'fortran_order': True, 'shape': (3,), }");
  std::array<char32_t, 6> codes{};
  ASSERT_EQ(data_of(npy).size(), sizeof codes);
  std::memcpy(codes.data(), data_of(npy).data(), sizeof codes);
  EXPECT_THAT(codes, ElementsAre(U'a', 0, 0xB5, U'm', 0x1D11E, 0));
}

TEST(NpzArchive, WritesFlagsAndWholeNumbers) {
  NpzArchive flags;
  flags.add("f", std::vector<bool>{true, false, true});
  EXPECT_EQ(data_of(first_file(flags.bytes())), std::string("\x01\x00\x01", 3));
  NpzArchive numbers;
  numbers.add("n", std::vector<std::int64_t>{-1});
  EXPECT_EQ(data_of(first_file(numbers.bytes())), std::string(8, '\xFF'));
}

}  // namespace
}  // namespace volcal
