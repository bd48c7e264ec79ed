// SPDX-License-Identifier: BSD-3-Clause
// hfremesh devices: the OpenCL devices that --device can name.
#include <fmt/format.h>

#include "Commands.hh"
#include "Console.hh"
#include "Json.hh"
#include "hfremesh/Device/Device.hh"

namespace hfr::app {
namespace {

Json to_json(const DeviceInfo& device) {
  Json json;
  json["id"] = device.id();
  json["name"] = device.name;
  json["vendor"] = device.vendor;
  json["platform"] = device.platform_name;
  json["version"] = device.version;
  json["driver"] = device.driver;
  json["cpu"] = device.is_cpu;
  json["compute_units"] = device.compute_units;
  json["memory"] = device.memory;
  json["max_allocation"] = device.max_allocation;
  json["fp64"] = device.has_double;
  json["usable"] = device.problem.empty();
  json["problem"] = device.problem.empty() ? Json() : Json(device.problem);
  return json;
}

ExitCode run(const CommonOptions& common, Json& report) {
  report["devices"] = Json::array();
  std::vector<DeviceInfo> devices;
  std::string problem;
  try {
    devices = list_devices();
  } catch (const std::exception& error) {
    problem = error.what();  // no loader is an answer to this question, not a failure
  }
  for (const DeviceInfo& device : devices) report["devices"].push_back(to_json(device));
  report["problem"] = problem.empty() ? Json() : Json(problem);
  if (!common.prints_table()) return ExitCode::kDone;
  if (devices.empty()) {
    print("no OpenCL device{}{}\n", problem.empty() ? "" : ": ", problem);
    return ExitCode::kDone;
  }
  print("{:<12}  {:<40}  {:>5}  {:>10}  {:<4}  {}\n", "device", "name", "units", "memory", "fp64", "usable");
  for (const DeviceInfo& device : devices) {
    print("{:<12}  {:<40.40}  {:>5}  {:>6} MiB  {:<4}  {}\n", device.id(), device.name, device.compute_units,
          device.memory >> 20, device.has_double ? "yes" : "no",
          device.problem.empty() ? "yes" : "no: " + device.problem);
    if (common.verbose)
      print("              {}; {}; driver {}; at most {} MiB in one buffer\n", device.platform_name,
            device.version, device.driver, device.max_allocation >> 20);
  }
  return ExitCode::kDone;
}

}  // namespace

Subcommand add_devices(Command program, CommonOptions& common) {
  Command command = program.subcommand("devices", "List the OpenCL devices that improve --device can use");
  command.example("hfremesh devices -v", "with driver and limits");
  add_common_options(command, common);
  return {command, [] { return std::vector<FileUse>(); },
          [&common](Json& report) { return run(common, report); }};
}

}  // namespace hfr::app
