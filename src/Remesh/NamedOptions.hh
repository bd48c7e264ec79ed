// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_REMESH_NAMED_OPTIONS_HH
#define HFR_REMESH_NAMED_OPTIONS_HH

#include <span>
#include <string>
#include <string_view>

#include "hfremesh/Remesh/Options.hh"
#include "hfremesh/Remesh/Remesher.hh"

/// Options as a name and a text, for whoever has them from a file or from another language. The names are the
/// tool's, with underscores; the C and the Python interface take these and no others.
namespace hfr {

struct NamedOption {
  const char* name;   ///< "min_dihedral"
  const char* value;  ///< what the text may be: "degrees in (0, 70.5), or max"
  const char* about;  ///< one sentence
  bool repeats;       ///< each text adds to those before, instead of taking their place
};

/// All of them, in the order in which they are best set: no_insert takes away from what ops has given.
std::span<const NamedOption> named_options();

/// Sets one; dashes in a name count as underscores. Flags take true, false, on, off, 1 and 0. Throws
/// InvalidInput, with `options` as they were, for a name that is not known or a text that the option does not
/// take: the line names the option and says what is wanted. What only the mesh can tell (whether a fixed
/// vertex exists) is left to improve().
void set_option(ImproveOptions& options, std::string_view name, std::string_view value);

/// Those of a Remesher beside the ones above, which are of its repairs.
std::span<const NamedOption> named_remesher_options();
/// Sets one of either kind.
void set_option(RemesherOptions& options, std::string_view name, std::string_view value);

}  // namespace hfr

#endif
