#pragma once

// The rooms, and whose names each may use without saying where they come from.
//
// Every room has a namespace of its own, named like its folder: harness/recording is touchstone::recording, and
// renderers is touchstone::renderers. What lies in harness/base is touchstone itself, so that all rooms see it. A
// using-directive below is an arrow of the house: the room may include the other's headers and use its names. What is
// not listed here is written in full. ci/rooms holds the namespaces against the folders. (harness/testing has its
// arrows in a header of its own: a `touchstone::testing` that every room sees would hide GoogleTest's namespace.)

namespace touchstone {

namespace recording {}
namespace surface {}
namespace stats {}

namespace metrics {
using namespace recording;
using namespace surface;
}  // namespace metrics

namespace acquisition {
using namespace recording;
using namespace surface;
}  // namespace acquisition

namespace importing {
using namespace recording;
}  // namespace importing

namespace rendering {
using namespace recording;
using namespace surface;
}  // namespace rendering

namespace plugin {
using namespace rendering;
using namespace recording;
using namespace surface;
}  // namespace plugin

namespace perception {
using namespace metrics;
using namespace recording;
}  // namespace perception

namespace baseline {
using namespace metrics;
using namespace recording;
}  // namespace baseline

namespace sanity {
using namespace rendering;
using namespace recording;
using namespace surface;
}  // namespace sanity

namespace discrepancy {
using namespace sanity;
using namespace rendering;
using namespace recording;
using namespace surface;
}  // namespace discrepancy

namespace diagnosis {
using namespace rendering;
using namespace recording;
using namespace surface;
}  // namespace diagnosis

namespace report {
using namespace metrics;
using namespace baseline;
using namespace recording;
using namespace surface;
}  // namespace report

namespace runs {
using namespace baseline;
}  // namespace runs

namespace pipeline {
using namespace baseline;
using namespace discrepancy;
using namespace metrics;
using namespace plugin;
using namespace recording;
using namespace rendering;
using namespace report;
using namespace runs;
using namespace sanity;
using namespace surface;
}  // namespace pipeline

namespace bisection {
using namespace report;
using namespace baseline;
}  // namespace bisection

namespace renderers {
using namespace rendering;
using namespace recording;
using namespace surface;
}  // namespace renderers

namespace synthetic {
using namespace recording;
using namespace surface;
}  // namespace synthetic

namespace hil {
using namespace recording;
}  // namespace hil

namespace apps {
using namespace acquisition;
using namespace baseline;
using namespace discrepancy;
using namespace importing;
using namespace metrics;
using namespace pipeline;
using namespace plugin;
using namespace recording;
using namespace renderers;
using namespace rendering;
using namespace report;
using namespace runs;
using namespace sanity;
using namespace surface;
}  // namespace apps

namespace experiments {
using namespace apps;
}  // namespace experiments

namespace atlas {
using namespace apps;
}  // namespace atlas

namespace blind {
using namespace apps;
}  // namespace blind

namespace bench {
using namespace apps;
}  // namespace bench

}  // namespace touchstone
