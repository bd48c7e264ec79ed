// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "Handles.hh"
#include "hfremesh/HalfFace/Config.hh"
#include "hfremesh/Remesh/NamedOptions.hh"

using hfr::c::guarded;
using hfr::c::text_of;

int hfr_abi_version(void) { return HFR_ABI_VERSION; }
const char* hfr_version(void) { return HFR_VERSION; }

namespace {

bool is_of_remesher(std::string_view name) {
  return std::ranges::any_of(hfr::named_remesher_options(), [&](const hfr::NamedOption& option) {
    return std::ranges::equal(name, std::string_view(option.name),
                              [](char a, char b) { return (a == '-' ? '_' : a) == b; });
  });
}

}  // namespace

hfr_options* hfr_options_new(void) { return new (std::nothrow) hfr_options; }
void hfr_options_free(hfr_options* options) { delete options; }

hfr_status hfr_options_set(hfr_options* options, const char* name, const char* value) {
  return guarded(options, [&] {
    const std::string_view called = text_of(name, "name"), text = text_of(value, "value");
    hfr::set_option(options->remesher, called, text);
    if (!is_of_remesher(called)) hfr::set_option(options->options, called, text);
  });
}

int hfr_options_name(size_t i, const char** name, const char** value, const char** about) {
  const auto first = hfr::named_options(), second = hfr::named_remesher_options();
  if (i >= first.size() + second.size()) return 0;
  const hfr::NamedOption& option = i < first.size() ? first[i] : second[i - first.size()];
  if (name) *name = option.name;
  if (value) *value = option.value;
  if (about) *about = option.about;
  return 1;
}

hfr_status hfr_options_on_progress(hfr_options* options, hfr_progress_callback call, void* user) {
  return guarded(options, [&] {
    options->options.progress = options->remesher.improve.progress = nullptr;
    if (!call) return;
    options->options.progress = options->remesher.improve.progress = [call, user](const hfr::Progress& now) {
      const hfr_progress shown = {now.stage.c_str(), now.iteration, now.fraction,
                                  static_cast<int64_t>(now.n_inverted), now.min_dihedral};
      call(&shown, user);
    };
  });
}

hfr_status hfr_options_on_cancel(hfr_options* options, hfr_cancel_callback ask, void* user) {
  return guarded(options, [&] {
    options->options.cancel = options->remesher.improve.cancel = nullptr;
    if (ask)
      options->options.cancel = options->remesher.improve.cancel = [ask, user] { return ask(user) != 0; };
  });
}

hfr_status hfr_options_on_transfer(hfr_options* options, const char* name, hfr_transfer_callback call,
                                   void* user) {
  return guarded(options, [&] {
    const std::string called(text_of(name, "name"));
    std::erase_if(options->on_transfer, [&](const hfr_options::OnTransfer& t) { return t.name == called; });
    if (call) options->on_transfer.push_back({called, call, user});
  });
}

const char* hfr_options_message(const hfr_options* options) {
  return options ? options->message.c_str() : "the options are NULL";
}
