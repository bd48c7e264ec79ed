// SPDX-License-Identifier: BSD-3-Clause
#include "IO/TextScanner.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "HalfFace/Errors.hh"

namespace hfr::io {
namespace {

TextScanner scan(std::string_view text, char comment = 0) { return {text, "f.txt", comment}; }

template <class Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "no error";
}

TEST(TextScanner, WordsAreSplitAtAnySpaceAndCommentsAreSkipped) {
  TextScanner in = scan("  one\ttwo # three\r\n#four\nfive#six\n", '#');
  EXPECT_EQ(in.word(), "one");
  EXPECT_EQ(in.peek_word(), "two");
  EXPECT_EQ(in.word(), "two");
  EXPECT_EQ(in.word(), "five");
  EXPECT_TRUE(in.at_end());
  EXPECT_EQ(in.peek_word(), "");
  EXPECT_EQ(message_of([&] { in.word(); }), "f.txt:4: the file ends too early: expected a word");
}

TEST(TextScanner, RealsOfEveryNotation) {
  TextScanner in =
      scan("1 -0.0 +2.5 1.5D+3 -1d-2 .5 5. 4.9406564584124654e-324 1.7976931348623157e308 1e-400 1E5");
  EXPECT_EQ(in.real(), 1.0);
  EXPECT_TRUE(std::signbit(in.real()));
  EXPECT_EQ(in.real(), 2.5);
  EXPECT_EQ(in.real(), 1500.0);
  EXPECT_EQ(in.real(), -0.01);
  EXPECT_EQ(in.real(), 0.5);
  EXPECT_EQ(in.real(), 5.0);
  EXPECT_EQ(in.real(), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(in.real(), std::numeric_limits<double>::max());
  EXPECT_EQ(in.real(), 0.0);
  EXPECT_EQ(in.real(), 1e5);
  EXPECT_TRUE(in.at_end());
}

TEST(TextScanner, WhatIsNoFiniteNumberIsNamedWithItsLine) {
  const auto message = [](std::string_view text) { return message_of([&] { scan(text).real(); }); };
  EXPECT_EQ(message("\n\n1.5x"), "f.txt:3: expected a number, found '1.5x'");
  EXPECT_EQ(message("nan"), "f.txt:1: expected a finite number, found 'nan'");
  EXPECT_EQ(message("-inf"), "f.txt:1: expected a finite number, found '-inf'");
  EXPECT_EQ(message("1e400"), "f.txt:1: expected a number that fits a double, found '1e400'");
  EXPECT_EQ(message("\xff\x01"), "f.txt:1: expected a number, found '\?\?'");
  EXPECT_EQ(message("+-1"), "f.txt:1: expected a number, found '+-1'");
  EXPECT_EQ(message(" \n"), "f.txt:2: the file ends too early: expected a number");
}

TEST(TextScanner, FieldValuesMayBeNanOrInfinite) {
  TextScanner in = scan("nan -inf 2");
  EXPECT_TRUE(std::isnan(in.field_value()));
  EXPECT_EQ(in.field_value(), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(in.field_value(), 2.0);
}

TEST(TextScanner, IntegersToTheEndsOfTheirRange) {
  TextScanner in = scan("0 -1 +7 999999999999999999 -9223372036854775808 9223372036854775807");
  EXPECT_EQ(in.integer(), 0);
  EXPECT_EQ(in.integer(), -1);
  EXPECT_EQ(in.integer(), 7);
  EXPECT_EQ(in.integer(), 999999999999999999);
  EXPECT_EQ(in.integer(), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(in.integer(), std::numeric_limits<std::int64_t>::max());
}

TEST(TextScanner, WhatIsNoIntegerIsNamed) {
  const auto message = [](std::string_view text) { return message_of([&] { scan(text).integer(); }); };
  EXPECT_EQ(message("3.0"), "f.txt:1: expected an integer, found '3.0'");
  EXPECT_EQ(message("-"), "f.txt:1: expected an integer, found '-'");
  EXPECT_EQ(message("9223372036854775808"),
            "f.txt:1: expected an integer of at most 64 bits, found '9223372036854775808'");
  EXPECT_EQ(message(""), "f.txt:1: the file ends too early: expected an integer");
  EXPECT_EQ(message_of([] { scan("\n9").integer_in(1, 8, "vertex"); }),
            "f.txt:2: vertex 9 is out of range (1 to 8)");
  EXPECT_EQ(message_of([] { scan("1").integer_in(1, 0, "vertex"); }),
            "f.txt:1: vertex 1 is out of range (there are none)");
}

TEST(TextScanner, ACountBeyondTheRestOfTheFileIsRefused) {
  EXPECT_EQ(scan("2 1 2 3 4").count(2, "number of edges"), 2U);
  EXPECT_EQ(message_of([] { scan("1000000000000000000 1 2").count(4, "number of cells"); }),
            "f.txt:1: number of cells 1000000000000000000 is more than the rest of the file can hold");
  EXPECT_EQ(message_of([] { scan("-1").count(4, "number of cells"); }).substr(0, 42),
            "f.txt:1: number of cells -1 is out of rang");
}

TEST(TextScanner, LinesCanBeTakenWholeAndSearched) {
  TextScanner in = scan("head  a b \nx\n  $Nodes no\n$Nodes yes\ntail");
  in.word();
  EXPECT_EQ(in.rest_of_line(), "a b");
  EXPECT_TRUE(in.skip_to_line_starting("$Nodes"));
  EXPECT_EQ(in.line(), 4U);
  EXPECT_EQ(in.rest_of_line(), "$Nodes yes");
  EXPECT_FALSE(in.skip_to_line_starting("$Nodes"));
  EXPECT_EQ(in.rest_of_line(), "tail");
  EXPECT_EQ(in.rest_of_line(), "");
}

}  // namespace
}  // namespace hfr::io
