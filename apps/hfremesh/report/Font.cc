// SPDX-License-Identifier: BSD-3-Clause
#include "Font.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

namespace hfr::view {
namespace {

/// A letter as strokes in a grid where capitals are 7 high, small letters 5, y goes up and 0 is the line that
/// they stand on. M x y: pen to there; L x y: line to there; A cx cy rx ry from to: an arc, degrees against
/// the clock; C: the same, with a line to its beginning.
struct Letter {
  char32_t code;
  double advance;  ///< to where the next one begins
  const char* strokes;
};

constexpr char32_t kDegreeSign = 0xb0;
constexpr char32_t kUnknown = 0;
constexpr Letter kLetters[] = {
    {kUnknown, 5.4, "M 0.7 0 L 0.7 7 L 4.7 7 L 4.7 0 L 0.7 0"},
    {' ', 2.8, ""},
    {'!', 1.9, "M 0.9 7 L 0.9 2.2 M 0.9 0 L 0.9 0.1"},
    {'"', 2.6, "M 0.7 7 L 0.7 5.2 M 1.9 7 L 1.9 5.2"},
    {'#', 5.8, "M 2.2 7 L 1.2 0 M 4.6 7 L 3.6 0 M 0.4 4.8 L 5.4 4.8 M 0.3 2.2 L 5.2 2.2"},
    {'$', 5.2, "A 2.6 5.1 1.9 1.5 35 270 C 2.6 1.8 2.1 1.8 90 -145 M 2.6 7.7 L 2.6 -0.8"},
    {'%', 7.4, "A 1.8 5.4 1.3 1.6 0 360 A 5.6 1.6 1.3 1.6 0 360 M 5.9 7 L 1.5 0"},
    {'&', 6.2, "M 5.8 0 L 1.6 4.8 C 2.7 5.6 1.4 1.4 200 -30 L 1.6 3.5 C 2.4 1.9 2.0 1.9 115 345 L 5.3 3.2"},
    {'\'', 1.5, "M 0.7 7 L 0.7 5.2"},
    {'(', 2.6, "A 3.4 2.8 2.7 4.9 120 240"},
    {')', 2.6, "A -0.8 2.8 2.7 4.9 60 -60"},
    {'*', 3.8, "M 1.9 7 L 1.9 4.2 M 0.7 6.3 L 3.1 4.9 M 3.1 6.3 L 0.7 4.9"},
    {'+', 4.8, "M 0.5 2.8 L 4.3 2.8 M 2.4 0.9 L 2.4 4.7"},
    {',', 1.9, "M 1 0.2 L 0.5 -1.2"},
    {'-', 3.2, "M 0.5 2.7 L 2.7 2.7"},
    {'.', 1.9, "M 0.9 0 L 0.9 0.1"},
    {'/', 3.6, "M 0.2 -0.8 L 3.3 7.4"},
    {'0', 5.2, "A 2.6 3.5 2.1 3.5 0 360"},
    {'1', 5.2, "M 1.1 5.6 L 2.9 7 L 2.9 0"},
    {'2', 5.2, "A 2.6 4.95 2.05 2.05 170 -38 L 0.6 0 L 4.7 0"},
    {'3', 5.2, "A 2.45 5.25 1.85 1.75 155 -90 C 2.45 1.75 2.1 1.75 90 -155"},
    {'4', 5.2, "M 3.7 0 L 3.7 7 L 0.4 2 L 4.9 2"},
    {'5', 5.2, "M 4.4 7 L 1.2 7 L 0.9 3.8 C 2.5 2.25 2.15 2.25 132 -150"},
    {'6', 5.2, "A 2.6 2.2 2.1 2.2 0 360 A 4.3 2.3 3.8 4.7 180 106"},
    {'7', 5.2, "M 0.5 7 L 4.7 7 L 1.8 0"},
    {'8', 5.2, "A 2.6 5.25 1.8 1.75 0 360 A 2.6 1.75 2.1 1.75 0 360"},
    {'9', 5.2, "A 2.6 4.8 2.1 2.2 0 360 A 0.9 4.7 3.8 4.7 0 -74"},
    {':', 1.9, "M 0.9 0 L 0.9 0.1 M 0.9 4 L 0.9 4.1"},
    {';', 1.9, "M 1 0.2 L 0.5 -1.2 M 0.9 4 L 0.9 4.1"},
    {'<', 4.6, "M 4 4.9 L 0.6 2.8 L 4 0.7"},
    {'=', 4.8, "M 0.5 3.8 L 4.3 3.8 M 0.5 1.8 L 4.3 1.8"},
    {'>', 4.6, "M 0.6 4.9 L 4 2.8 L 0.6 0.7"},
    {'?', 4.6, "A 2.2 5.2 1.8 1.8 165 -50 L 2.2 2.8 L 2.2 2.2 M 2.2 0 L 2.2 0.1"},
    {'@', 7.6, "A 3.6 2.6 1.3 1.6 0 360 M 4.9 4.2 L 4.9 1.6 C 5.8 2 0.9 1 200 340 A 3.7 2.7 3.1 3.6 -12 300"},
    {'A', 5.8, "M 0.2 0 L 2.9 7 L 5.6 0 M 1.15 2.4 L 4.65 2.4"},
    {'B', 5.4,
     "M 0.7 0 L 0.7 7 L 2.8 7 C 2.8 5.35 1.6 1.65 90 -90 L 0.7 3.7 M 2.8 3.7 C 3 1.85 1.9 1.85 90 -90 L 0.7 "
     "0"},
    {'C', 6.0, "A 3.3 3.5 2.8 3.5 48 312"},
    {'D', 6.0, "M 0.7 0 L 0.7 7 L 2.4 7 C 2.4 3.5 3 3.5 90 -90 L 0.7 0"},
    {'E', 5.1, "M 4.5 7 L 0.7 7 L 0.7 0 L 4.6 0 M 0.7 3.7 L 4 3.7"},
    {'F', 4.8, "M 4.4 7 L 0.7 7 L 0.7 0 M 0.7 3.7 L 3.9 3.7"},
    {'G', 6.4, "A 3.3 3.5 2.8 3.5 48 322 L 5.6 3.2 L 3.6 3.2"},
    {'H', 6.0, "M 0.7 0 L 0.7 7 M 5.3 0 L 5.3 7 M 0.7 3.7 L 5.3 3.7"},
    {'I', 1.6, "M 0.8 0 L 0.8 7"},
    {'J', 3.9, "M 3.2 7 L 3.2 2 C 1.7 2 1.5 2 0 -170"},
    {'K', 5.5, "M 0.7 0 L 0.7 7 M 5 7 L 0.7 2.8 M 2.2 4.3 L 5.3 0"},
    {'L', 4.7, "M 0.7 7 L 0.7 0 L 4.4 0"},
    {'M', 7.0, "M 0.7 0 L 0.7 7 L 3.5 1.8 L 6.3 7 L 6.3 0"},
    {'N', 5.9, "M 0.7 0 L 0.7 7 L 5.2 0 L 5.2 7"},
    {'O', 6.8, "A 3.4 3.5 2.9 3.5 0 360"},
    {'P', 5.2, "M 0.7 0 L 0.7 7 L 2.9 7 C 2.9 5.1 1.9 1.9 90 -90 L 0.7 3.2"},
    {'Q', 6.8, "A 3.4 3.5 2.9 3.5 0 360 M 3.9 1.7 L 6 -0.6"},
    {'R', 5.4, "M 0.7 0 L 0.7 7 L 2.9 7 C 2.9 5.2 1.9 1.8 90 -90 L 0.7 3.4 M 2.9 3.4 L 5.1 0"},
    {'S', 5.2, "A 2.6 5.25 2 1.75 35 270 C 2.6 1.75 2.2 1.75 90 -145"},
    {'T', 5.2, "M 0.2 7 L 5 7 M 2.6 7 L 2.6 0"},
    {'U', 5.9, "M 0.7 7 L 0.7 2.4 C 2.95 2.4 2.25 2.4 180 360 L 5.2 7"},
    {'V', 5.6, "M 0.2 7 L 2.8 0 L 5.4 7"},
    {'W', 8.4, "M 0.2 7 L 2.2 0 L 4.2 7 L 6.2 0 L 8.2 7"},
    {'X', 5.4, "M 0.4 7 L 5 0 M 5 7 L 0.4 0"},
    {'Y', 5.4, "M 0.2 7 L 2.7 3.4 L 5.2 7 M 2.7 3.4 L 2.7 0"},
    {'Z', 5.4, "M 0.5 7 L 4.9 7 L 0.4 0 L 5 0"},
    {'[', 2.5, "M 2.1 7.6 L 0.8 7.6 L 0.8 -1.2 L 2.1 -1.2"},
    {'\\', 3.6, "M 0.3 7.4 L 3.4 -0.8"},
    {']', 2.5, "M 0.4 7.6 L 1.7 7.6 L 1.7 -1.2 L 0.4 -1.2"},
    {'^', 4.4, "M 0.5 4.6 L 2.2 7 L 3.9 4.6"},
    {'_', 4.8, "M 0.2 -0.9 L 4.6 -0.9"},
    {'`', 2.2, "M 0.5 7.2 L 1.6 6"},
    {'a', 4.9, "A 2.3 2.5 1.9 2.5 0 360 M 4.2 5 L 4.2 0"},
    {'b', 4.9, "M 0.7 7.3 L 0.7 0 A 2.6 2.5 1.9 2.5 0 360"},
    {'c', 4.4, "A 2.5 2.5 2.1 2.5 48 312"},
    {'d', 4.9, "M 4.2 7.3 L 4.2 0 A 2.3 2.5 1.9 2.5 0 360"},
    {'e', 4.8, "M 0.45 2.6 L 4.35 2.6 C 2.4 2.5 2 2.5 2 316"},
    {'f', 3.0, "M 1 0 L 1 5.6 C 2.5 5.6 1.5 1.7 180 84 M 0.1 5 L 2.7 5"},
    {'g', 4.9, "A 2.3 2.5 1.9 2.5 0 360 M 4.2 5 L 4.2 -0.3 C 2.3 -0.3 1.9 1.8 0 -148"},
    {'h', 4.9, "M 0.7 7.3 L 0.7 0 A 2.45 3.1 1.75 1.9 180 0 L 4.2 0"},
    {'i', 1.6, "M 0.8 5 L 0.8 0 M 0.8 6.9 L 0.8 7"},
    {'j', 2.0, "M 1.2 5 L 1.2 -0.8 C 0.2 -0.8 1 1.2 0 -90 M 1.2 6.9 L 1.2 7"},
    {'k', 4.4, "M 0.7 7.3 L 0.7 0 M 3.9 5 L 0.7 2 M 1.9 3.1 L 4.2 0"},
    {'l', 1.6, "M 0.8 7.3 L 0.8 0"},
    {'m', 7.0, "M 0.7 5 L 0.7 0 A 2.1 3.4 1.4 1.6 180 0 L 3.5 0 A 4.9 3.4 1.4 1.6 180 0 L 6.3 0"},
    {'n', 4.9, "M 0.7 5 L 0.7 0 A 2.45 3.1 1.75 1.9 180 0 L 4.2 0"},
    {'o', 5.0, "A 2.5 2.5 2.1 2.5 0 360"},
    {'p', 4.9, "M 0.7 5 L 0.7 -2 A 2.6 2.5 1.9 2.5 0 360"},
    {'q', 4.9, "M 4.2 5 L 4.2 -2 A 2.3 2.5 1.9 2.5 0 360"},
    {'r', 3.3, "M 0.7 5 L 0.7 0 A 2.6 2.9 1.9 2.1 180 74"},
    {'s', 4.1, "A 2.05 3.72 1.5 1.28 38 270 C 2.05 1.22 1.65 1.22 90 -142"},
    {'t', 3.2, "M 1.2 6.7 L 1.2 1.5 C 2.6 1.5 1.4 1.5 180 285 M 0.1 5 L 2.9 5"},
    {'u', 4.9, "M 0.7 5 L 0.7 1.9 C 2.45 1.9 1.75 1.9 180 360 M 4.2 5 L 4.2 0"},
    {'v', 4.4, "M 0.2 5 L 2.2 0 L 4.2 5"},
    {'w', 6.4, "M 0.2 5 L 1.7 0 L 3.2 5 L 4.7 0 L 6.2 5"},
    {'x', 4.2, "M 0.3 5 L 3.9 0 M 3.9 5 L 0.3 0"},
    {'y', 4.4, "M 0.2 5 L 2.2 0 M 4.2 5 L 1.5 -2"},
    {'z', 4.2, "M 0.4 5 L 3.8 5 L 0.4 0 L 3.9 0"},
    {'{', 2.8, "M 2.5 7.6 L 1.6 7.2 L 1.6 3.8 L 0.6 3.2 L 1.6 2.6 L 1.6 -0.8 L 2.5 -1.2"},
    {'|', 1.8, "M 0.9 7.6 L 0.9 -1.4"},
    {'}', 2.8, "M 0.3 7.6 L 1.2 7.2 L 1.2 3.8 L 2.2 3.2 L 1.2 2.6 L 1.2 -0.8 L 0.3 -1.2"},
    {'~', 4.8, "A 1.5 2.5 1 0.7 180 0 A 3.5 2.6 1 0.7 180 360"},
    {kDegreeSign, 3.0, "A 1.4 5.8 1.05 1.15 0 360"},
};

constexpr double kGrid = 10;  // grid units from line to line

/// Grid units between letters, beyond what they bring along: thick strokes need more.
double tracking(const TextStyle& style) { return style.bold ? 0.5 : 0.15; }

const Letter& letter_of(char32_t code) {
  const auto* const found =
      std::find_if(std::begin(kLetters), std::end(kLetters), [&](const Letter& l) { return l.code == code; });
  return found == std::end(kLetters) ? kLetters[0] : *found;
}

/// What begins at `at`, which goes to the next. Bytes that are no UTF-8 are letters of their own.
char32_t next_code(std::string_view text, std::size_t& at) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const char32_t first = byte(at++);
  if (first < 0xc0) return first;
  const int more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : 1;
  char32_t code = first & (0x3fU >> more);
  for (int i = 0; i < more && (byte(at) & 0xc0) == 0x80; ++i) code = code << 6 | (byte(at++) & 0x3fU);
  return code;
}

struct Segment {
  double x0, y0, x1, y1;
};

/// Adds the arc's segments, 15 degrees each at most; returns its end.
std::array<double, 2> add_arc(std::istringstream& in, bool joined, std::array<double, 2> pen,
                              std::vector<Segment>& out) {
  double cx = 0, cy = 0, rx = 0, ry = 0, from = 0, to = 0;
  in >> cx >> cy >> rx >> ry >> from >> to;
  const int n = std::max(1, static_cast<int>(std::ceil(std::abs(to - from) / 15)));
  for (int i = 0; i <= n; ++i) {
    const double t = (from + (to - from) * i / n) * std::numbers::pi / 180;
    const std::array<double, 2> next = {cx + rx * std::cos(t), cy + ry * std::sin(t)};
    if (i > 0 || joined) out.push_back({pen[0], pen[1], next[0], next[1]});
    pen = next;
  }
  return pen;
}

std::vector<Segment> segments_of(const Letter& letter) {
  std::vector<Segment> segments;
  std::istringstream in(letter.strokes);
  std::array<double, 2> pen{};
  for (char command = 0; in >> command;) {
    if (command == 'A' || command == 'C') {
      pen = add_arc(in, command == 'C', pen, segments);
      continue;
    }
    std::array<double, 2> next{};
    in >> next[0] >> next[1];
    if (command == 'L') segments.push_back({pen[0], pen[1], next[0], next[1]});
    pen = next;
  }
  return segments;
}

void draw_letter(Canvas& canvas, double x, double y, const Letter& letter, const TextStyle& style) {
  const double unit = canvas.scale() * style.size / kGrid;  // pixels
  x *= canvas.scale();
  y *= canvas.scale();
  const double half = 0.5 * std::max(style.bold ? 1.35 * unit : 0.92 * unit, 1.0);  // pixels
  const std::vector<Segment> segments = segments_of(letter);
  if (segments.empty()) return;
  const int x_end = static_cast<int>(std::ceil(x + unit * letter.advance + 2 * half + 1));
  const int y_end = static_cast<int>(std::ceil(y + 2.2 * unit + 2 * half));
  for (int py = static_cast<int>(std::floor(y - 7.8 * unit - 2 * half)); py < y_end; ++py)
    for (int px = static_cast<int>(std::floor(x - 2 * half - 1)); px < x_end; ++px) {
      double nearest = 1e9;
      for (const Segment& s : segments)
        nearest = std::min(nearest, distance_to_segment(px + 0.5, py + 0.5, x + unit * s.x0, y - unit * s.y0,
                                                        x + unit * s.x1, y - unit * s.y1));
      canvas.blend(px, py, style.colour, static_cast<float>(std::clamp(half + 0.5 - nearest, 0.0, 1.0)));
    }
}

}  // namespace

double text_width(std::string_view text, const TextStyle& style) {
  double width = 0;
  for (std::size_t at = 0; at < text.size();)
    width += letter_of(next_code(text, at)).advance + tracking(style);
  return width * style.size / kGrid;
}

void draw_text(Canvas& canvas, double x, double y, std::string_view text, const TextStyle& style) {
  if (style.align == Align::kCentre) x -= 0.5 * text_width(text, style);
  if (style.align == Align::kRight) x -= text_width(text, style);
  for (std::size_t at = 0; at < text.size();) {
    const Letter& letter = letter_of(next_code(text, at));
    draw_letter(canvas, x, y, letter, style);
    x += (letter.advance + tracking(style)) * style.size / kGrid;
  }
}

std::string shortened(std::string_view text, double width, const TextStyle& style) {
  if (text_width(text, style) <= width) return std::string(text);
  const auto is_inside = [&](std::size_t at) {  // of a letter of several bytes
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80;
  };
  for (std::size_t half = text.size() / 2; half > 0; --half) {
    std::size_t head = half, tail = text.size() - half;
    while (is_inside(head)) --head;
    while (is_inside(tail)) ++tail;
    const std::string cut = std::string(text.substr(0, head)) + "..." + std::string(text.substr(tail));
    if (text_width(cut, style) <= width) return cut;
  }
  return "...";
}

}  // namespace hfr::view
