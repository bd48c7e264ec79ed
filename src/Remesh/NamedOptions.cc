// SPDX-License-Identifier: BSD-3-Clause
#include "Remesh/NamedOptions.hh"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>

#include "HalfFace/Errors.hh"

namespace hfr {
namespace {

/// Thrown by setters, who do not know their option's name.
struct Unwanted {};

template <class Number>
Number number(std::string_view text, Number low, Number high) {
  Number value{};
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && stop == text.data() + text.size();
  if (!whole || !(value >= low && value <= high)) throw Unwanted();
  return value;
}

template <class Number>
Number number_from(std::string_view text, Number low) {
  return number(text, low, std::numeric_limits<Number>::max());
}

bool flag(std::string_view text) {
  if (text == "true" || text == "on" || text == "1") return true;
  if (text == "false" || text == "off" || text == "0") return false;
  throw Unwanted();
}

/// The N numbers that follow `prefix`, with `separator` between them.
template <std::size_t N, class Integer>
std::array<Integer, N> numbers_after(std::string_view text, std::string_view prefix, char separator) {
  text.remove_prefix(prefix.size());
  std::array<Integer, N> numbers;
  for (std::size_t i = 0; i < N; ++i) {
    const std::size_t end = i + 1 < N ? text.find(separator) : text.size();
    if (end > text.size()) throw Unwanted();
    numbers[i] =
        number(text.substr(0, end), std::numeric_limits<Integer>::min(), std::numeric_limits<Integer>::max());
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return numbers;
}

template <std::size_t N>
std::array<VertexHandle, N> vertices_after(std::string_view text, std::string_view prefix) {
  std::array<VertexHandle, N> vertices;
  const auto numbers = numbers_after<N, std::uint64_t>(text, prefix, '-');
  for (std::size_t i = 0; i < N; ++i) {
    if (numbers[i] >= VertexHandle::kInvalid) throw Unwanted();
    vertices[i] = VertexHandle(numbers[i]);
  }
  return vertices;
}

void set_min_dihedral(ImproveOptions& o, std::string_view text) {
  constexpr double kLargestDihedral = 70.5;  // degrees; the regular tetrahedron has 70.53
  std::optional<double> degrees;
  if (text != "max") {
    degrees = number(text, 0.0, kLargestDihedral);
    if (*degrees == 0 || *degrees == kLargestDihedral) throw Unwanted();
  }
  o.raise_min_dihedral = !degrees;
  o.min_dihedral = degrees;
}

void set_time_limit(ImproveOptions& o, std::string_view text) {
  const double seconds = number_from(text, 0.0);
  if (seconds == 0) throw Unwanted();
  o.time_limit = seconds;
}

void set_surface(ImproveOptions& o, std::string_view text) {
  if (text == "frozen")
    o.surface.mode = SurfaceMode::kFrozen;
  else if (text == "flat")
    o.surface.mode = SurfaceMode::kFlat;
  else if (text == "free")
    o.surface.mode = SurfaceMode::kFree;
  else
    throw Unwanted();
}

void set_compat(ImproveOptions& o, std::string_view text) {
  if (text != "none" && text != "jpdc2013") throw Unwanted();
  o.compat = text == "none" ? Compat::kNone : Compat::kJpdc2013;
}

void add_fixed(ImproveOptions& o, std::string_view text) {
  if (text.starts_with("patch:"))
    o.surface.fixed_patches.push_back(numbers_after<1, int>(text, "patch:", '-')[0]);
  else if (text.starts_with("vertex:"))
    o.surface.fixed_vertices.push_back(vertices_after<1>(text, "vertex:")[0]);
  else if (text.starts_with("edge:"))
    o.surface.fixed_edges.push_back(vertices_after<2>(text, "edge:"));
  else if (text.starts_with("face:"))
    o.surface.fixed_faces.push_back(vertices_after<3>(text, "face:"));
  else
    throw Unwanted();
}

void set_work_group(ImproveOptions& o, std::string_view text) {
  const auto n = number(text, 0U, 256U);
  if ((n & (n - 1)) != 0) throw Unwanted();
  o.device_tuning.work_group = n;
}

void set_threads(ImproveOptions& o, std::string_view text) {
  const int n = number(text, 0, 1024);
  o.policy.threads = n > 0 ? n : par::Policy::all().threads;
}

constexpr const char* kFlag = "true or false";

template <class Options>
struct Row {
  NamedOption option;
  void (*set)(Options&, std::string_view);
};
using O = ImproveOptions;
using Text = std::string_view;
constexpr std::array kRows = std::to_array<Row<O>>({
    {{"min_dihedral", "degrees in (0, 70.5), or max",
      "Goal for the smallest dihedral angle: only cells that miss it are worked on; max: as large as can be "
      "had. Without it the whole mesh is improved.",
      false},
     set_min_dihedral},
    {{"iterations", "a whole number from 0",
      "At most so many bulk iterations, or all iterations with a goal; 0 is no limit.", false},
     [](O& o, Text t) { o.iterations = number_from(t, 0); }},
    {{"time_limit", "seconds above 0", "Stop improving after so long.", false}, set_time_limit},
    {{"surface", "frozen, flat or free",
      "What may happen to the surface: nothing; new triangles in planar faces; anything within hausdorff.",
      false},
     set_surface},
    {{"hausdorff", "a length from 0",
      "Largest distance between the surfaces before and after, with surface free. Default: 0.3 of the "
      "surface's mean edge, at most 0.5 % of the diagonal.",
      false},
     [](O& o, Text t) { o.surface.hausdorff = number_from(t, 0.0); }},
    {{"feature_angle", "degrees from 0 to 180",
      "Surface edges sharper than this stay, with surface free; 40 by default.", false},
     [](O& o, Text t) { o.surface.feature_angle = number(t, 0.0, 180.0); }},
    {{"fix", "patch:N, vertex:N, edge:N-N or face:N-N-N, counted from 0",
      "Keep this as it is, on the surface and inside.", true},
     add_fixed},
    {{"periodic", "A:B, two patches",
      "Patches that match each other by a translation: their vertices move together.", true},
     [](O& o, Text t) { o.surface.periodic.push_back(numbers_after<2, int>(t, "", ':')); }},
    {{"min_cells", "a whole number from 0",
      "No vertex is removed below so many cells; 0: 81 % of the input's, or as docs/tool.md says.", false},
     [](O& o, Text t) { o.min_cells = number_from<std::size_t>(t, 0); }},
    {{"max_cells", "a whole number from 0",
      "No new vertices beyond so many cells; 0: 119 % of the input's, or as docs/tool.md says.", false},
     [](O& o, Text t) { o.max_cells = number_from<std::size_t>(t, 0); }},
    {{"coarsen", kFlag, "Remove vertices wherever that makes the worst angles there better.", false},
     [](O& o, Text t) { o.coarsen = flag(t); }},
    {{"metric",
      "volume-length, min-dihedral, max-dihedral, min-sine, mean-ratio, radius-ratio, scaled-jacobian, "
      "edge-ratio or volume",
      "Quality metric of the bulk passes; volume-length by default.", false},
     [](O& o, Text t) { o.metric = metric_from_name(t); }},
    {{"ops", "a list of edge, face, node, smooth, insert, cluster, with commas between",
      "Operators that may work; all but cluster by default.", false},
     [](O& o, Text t) { o.ops = ops_from_list(std::string(t)); }},
    {{"no_insert", kFlag, "No new vertices: takes insert from ops, or gives it back.", false},
     [](O& o, Text t) { o.ops = flag(t) ? without(o.ops, Ops::kInsert) : o.ops | Ops::kInsert; }},
    {{"bulk_nodes", kFlag, "Remove vertices in the bulk stage, too.", false},
     [](O& o, Text t) { o.bulk_nodes = flag(t); }},
    {{"polish_only", kFlag, "With min_dihedral: the polish alone, without other targets and patches.", false},
     [](O& o, Text t) { o.polish_only = flag(t); }},
    {{"passes_only", kFlag, "Every stage but patches and neighbourhoods of the last cells.", false},
     [](O& o, Text t) { o.passes_only = flag(t); }},
    {{"rounds", "auto, by-kind or mixed", "Kinds of operators in turn, or in one selection.", false},
     [](O& o, Text t) { o.rounds = rounds_from_name(std::string(t)); }},
    {{"smoother", "newton, candidates, laplacian or taubin", "How vertices are moved.", false},
     [](O& o, Text t) { o.smoother = smoother_from_name(std::string(t)); }},
    {{"compat", "none or jpdc2013", "Run a published pipeline exactly.", false}, set_compat},
    {{"seed", "a whole number from 0", "Seed of the order among equal candidates; 1 by default.", false},
     [](O& o, Text t) { o.seed = number_from<std::uint64_t>(t, 0); }},
    {{"threads", "a whole number from 0 to 1024",
      "Threads; 0, the default, is every core. The result does not depend on it.", false},
     set_threads},
    {{"device", "cpu, auto, opencl or opencl:PLATFORM.DEVICE",
      "Where the large passes run; the result does not depend on it.", false},
     [](O& o, Text t) { o.device = device_choice_from_name(std::string(t)); }},
    {{"hybrid", kFlag, "On a device, smooth only, and reconnect on the processor.", false},
     [](O& o, Text t) { o.hybrid = flag(t); }},
    {{"work_group", "0, or a power of two up to 256", "Work-items of a group on a device; 0 chooses.", false},
     set_work_group},
});

void set_on_inversion(RemesherOptions& o, std::string_view text) {
  if (text == "repair")
    o.on_inversion = OnInversion::kRepair;
  else if (text == "substeps")
    o.on_inversion = OnInversion::kSubsteps;
  else if (text == "refuse")
    o.on_inversion = OnInversion::kRefuse;
  else
    throw Unwanted();
}

void set_motion(RemesherOptions& o, std::string_view text) {
  if (text == "given")
    o.motion = Motion::kGiven;
  else if (text == "laplace")
    o.motion = Motion::kLaplace;
  else if (text == "elastic")
    o.motion = Motion::kElastic;
  else
    throw Unwanted();
}

/// Before and after the last colon; throws where there is none, or nothing on one side of it.
std::array<std::string_view, 2> halves(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || colon == 0 || colon + 1 == text.size()) throw Unwanted();
  return {text.substr(0, colon), text.substr(colon + 1)};
}

void add_metric_trigger(RemesherOptions& o, std::string_view text) {
  const auto [name, bound] = halves(text);
  constexpr double kMost = std::numeric_limits<double>::max();
  o.triggers.metrics.emplace_back(metric_from_name(name), number(bound, -kMost, kMost));
}

void add_transfer(RemesherOptions& o, std::string_view text) {
  auto [name, how] = halves(text);
  FieldTransfer transfer;
  constexpr std::string_view kWeighted = ":conserve";
  if (name.ends_with(kWeighted) && name.size() > kWeighted.size()) {
    transfer.density = how;
    how = kWeighted.substr(1);
    name.remove_suffix(kWeighted.size());
  }
  transfer.name = name;
  transfer.how = transfer_from_name(how);
  if (transfer.how == Transfer::kCallback) throw Unwanted();
  o.fields.push_back(std::move(transfer));
}

using R = RemesherOptions;
constexpr std::array kRemesherRows = std::to_array<Row<R>>({
    {{"trigger", "degrees from 0 to 70.5",
      "A cell with a smaller dihedral calls for a repair; 10 by default, 0: not "
      "looked at.",
      false},
     [](R& o, Text t) { o.triggers.min_dihedral = number(t, 0.0, 70.5); }},
    {{"trigger_inverted", kFlag, "A cell that is inverted or flat calls for a repair; true by default.",
      false},
     [](R& o, Text t) { o.triggers.inverted = flag(t); }},
    {{"trigger_metric", "METRIC:VALUE", "A cell that is worse by this metric calls for a repair.", true},
     add_metric_trigger},
    {{"trigger_jacobian", "a number from 0 to 1",
      "A cell with less than this share of its first volume calls for a "
      "repair; 0: not looked at.",
      false},
     [](R& o, Text t) { o.triggers.jacobian_ratio = number(t, 0.0, 1.0); }},
    {{"trigger_motion", "a number from 0",
      "A vertex that has come so many mean edges calls for a repair; 0: not looked "
      "at.",
      false},
     [](R& o, Text t) { o.triggers.motion = number_from(t, 0.0); }},
    {{"trigger_every", "a whole number from 0", "A repair after so many steps; 0: not counted.", false},
     [](R& o, Text t) { o.triggers.every = number_from(t, 0); }},
    {{"trigger_field", "the name of a field of cells",
      "A cell in which this field is not 0 calls for a repair.", false},
     [](R& o, Text t) {
       if (t.empty()) throw Unwanted();
       o.triggers.indicator_field = t;
     }},
    {{"on_inversion", "repair, substeps or refuse", "What a move does that would invert cells.", false},
     set_on_inversion},
    {{"max_substeps", "a whole number from 1", "Moves of a step with on_inversion substeps; 16 by default.",
      false},
     [](R& o, Text t) { o.max_substeps = number_from(t, 1); }},
    {{"motion", "given, laplace or elastic",
      "Whose displacement is given: that of every vertex, or of the boundary and "
      "of fixed vertices, which others follow.",
      false},
     set_motion},
    {{"transfer", "NAME:linear, NAME:quadratic, NAME:inherit, NAME:conserve or NAME:conserve:DENSITY",
      "A field that is carried over repairs, and how.", true},
     add_transfer},
    {{"parents", kFlag,
      "The edits of a repair can be asked for the parents of created cells, and keep the mesh as it was for "
      "that; "
      "true by default.",
      false},
     [](R& o, Text t) { o.parents = flag(t); }},
    {{"ids", kFlag, "Keep numbers of vertices and cells that never change.", false},
     [](R& o, Text t) { o.ids = flag(t); }},
});

template <class Rows>
constexpr auto options_of(const Rows& rows) {
  std::array<NamedOption, std::tuple_size_v<Rows>> options{};
  for (std::size_t i = 0; i < options.size(); ++i) options[i] = rows[i].option;
  return options;
}
constexpr auto kOptions = options_of(kRows);
constexpr auto kRemesherOptions = options_of(kRemesherRows);

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  return "'" + std::string(text.substr(0, kLongest)) + (text.size() > kLongest ? "..." : "") + "'";
}

std::string names_of(std::span<const NamedOption> options) {
  std::string names;
  for (const NamedOption& option : options) names += std::string(names.empty() ? "" : ", ") + option.name;
  return names;
}

/// The row of the name; nullptr when there is none.
template <class Rows>
const typename Rows::value_type* find_row(const Rows& rows, std::string_view name) {
  const auto row = std::ranges::find_if(rows, [&](const auto& r) {
    return std::ranges::equal(name, std::string_view(r.option.name),
                              [](char a, char b) { return a == b || (a == '-' && b == '_'); });
  });
  return row == rows.end() ? nullptr : &*row;
}

template <class Options>
void set(const Row<Options>& row, Options& options, std::string_view value) {
  try {
    row.set(options, value);
  } catch (const Unwanted&) {
    throw InvalidInput(std::string(row.option.name) + ": " + row.option.value + " is wanted, not " +
                       in_quotes(value));
  } catch (const InvalidInput& error) {
    throw InvalidInput(std::string(row.option.name) + ": " + error.what());
  }
}

}  // namespace

std::span<const NamedOption> named_options() { return kOptions; }
std::span<const NamedOption> named_remesher_options() { return kRemesherOptions; }

void set_option(ImproveOptions& options, std::string_view name, std::string_view value) {
  const auto* row = find_row(kRows, name);
  HFR_REQUIRE(row, "no option is called " + in_quotes(name) + "; there are " + names_of(kOptions));
  set(*row, options, value);
}

void set_option(RemesherOptions& options, std::string_view name, std::string_view value) {
  if (const auto* row = find_row(kRemesherRows, name)) return set(*row, options, value);
  const auto* row = find_row(kRows, name);
  HFR_REQUIRE(row, "no option is called " + in_quotes(name) + "; there are " + names_of(kOptions) + ", " +
                       names_of(kRemesherOptions));
  set(*row, options.improve, value);
}

}  // namespace hfr
