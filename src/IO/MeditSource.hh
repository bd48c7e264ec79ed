// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_IO_MEDIT_SOURCE_HH
#define HFR_IO_MEDIT_SOURCE_HH

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "IO/InputFile.hh"
#include "IO/TextScanner.hh"

/// Medit's keywords and the two ways in which a file holds them. A reader that is written once over a source
/// reads both .mesh and .meshb, .sol and .solb.
namespace hfr::io::medit {

/// The keywords by their codes in binary files (libMeshb's numbers); kUnknown for one that has none here.
enum class Keyword : int {
  kUnknown = 0,
  kDimension = 3,
  kVertices = 4,
  kEdges = 5,
  kTriangles = 6,
  kTetrahedra = 8,
  kCorners = 13,
  kRequiredVertices = 15,
  kRequiredEdges = 16,
  kRequiredTriangles = 17,
  kTrianglesP2 = 24,
  kEdgesP2 = 25,
  kTetrahedraP2 = 30,
  kEnd = 54,
  kSolAtVertices = 62,
  kSolAtTetrahedra = 66,
};

/// A section's heading. The name is empty when a binary file has a code that is not known here.
struct Heading {
  Keyword keyword = Keyword::kUnknown;
  int code = 0;
  std::string_view name;
};

/// Every keyword begins with a capital; numbers, nan and inf do not.
bool is_keyword(std::string_view word);
Heading heading_of(std::string_view name);
Heading heading_of(int code);
/// Cells that are no tetrahedra, or tetrahedra of an order above two: a file that has any is refused.
bool is_unsupported_cell(std::string_view name);

/// Number of components of a solution's type, as stored in .sol files (1 scalar, 2 vector, 3 symmetric
/// tensor, 4 tensor); 0 when there is no such type.
int components_of_type(std::int64_t type);
int type_of_components(int components);  ///< 0 when there is none

class AsciiSource {
 public:
  explicit AsciiSource(const InputFile& file);
  /// The next section, past the dimension; nothing at the keyword End or the end of the file.
  std::optional<Heading> next();
  bool saw_end() const { return saw_end_; }
  /// Of the entries of section `name`, of so many numbers each.
  std::size_t count(std::string_view name, std::size_t integers, std::size_t reals);
  /// Whether the next section begins here, or the file ends.
  bool at_section_end();
  double coordinate() { return text_.real(); }
  double value() { return text_.field_value(); }
  std::int64_t integer_in(std::int64_t low, std::int64_t high, std::string_view what) {
    return text_.integer_in(low, high, what);
  }
  std::int64_t short_integer() { return text_.integer(); }
  /// How many entries the section announces, 0 when it says nothing; for sections that skip() then passes
  /// over.
  std::size_t announced();
  void skip();
  [[noreturn]] void fail(std::string_view message) const { text_.fail(message); }

 private:
  TextScanner text_;
  bool saw_end_ = false;
};

class BinarySource {
 public:
  explicit BinarySource(const InputFile& file);
  std::optional<Heading> next();
  bool saw_end() const { return saw_end_; }
  std::size_t count(std::string_view name, std::size_t integers, std::size_t reals);
  bool at_section_end() const { return at_ >= section_end(); }
  double coordinate();
  double value();
  std::int64_t integer_in(std::int64_t low, std::int64_t high, std::string_view what);
  std::int64_t short_integer();  ///< always of 32 bits
  std::size_t announced();
  void skip() {}
  [[noreturn]] void fail(std::string_view message) const;

 private:
  template <class T>
  T take();
  std::int64_t integer();
  std::uint64_t position();
  std::size_t section_end() const { return next_ == 0 ? bytes_.size() : next_; }

  std::string_view bytes_;
  std::string name_;
  std::size_t at_ = 0;
  std::size_t next_ = 0;  ///< where the next section begins; 0 when this is the last
  int version_ = 0;       ///< 1 float; 2 double; 3 with 64-bit positions; 4 with 64-bit integers too
  bool swapped_ = false;  ///< the file's byte order is not this machine's
  bool saw_end_ = false;
};

/// What a section that breaks off is refused with.
std::string too_few_entries(std::string_view name, std::int64_t announced, std::size_t found);

/// What is wrong with a file that begins with `word` and not with MeshVersionFormatted.
std::string no_medit_file(std::string_view word);

/// Is this a binary file, whatever it is called?
bool is_binary(const InputFile& file);

}  // namespace hfr::io::medit

#endif
