// SPDX-License-Identifier: GPL-3.0-or-later
// The cases that `lacuna new` writes: a block, a joint and a slope, with comments to learn from.
#include "cli/common/templates.h"

// Comments that every case starts and ends with.
#define HEAD                                                                                  \
    "# A case of Lacuna. Check it:  lacuna check FILE      run it:  lacuna run FILE\n"        \
    "# Values with a dimension are texts with a unit (\"0.1 mm\", \"3 MPa\", \"2 week\"); a " \
    "bare\n"                                                                                  \
    "# number is SI. lacuna describe lists all models, parameters, ranges and defaults.\n"    \
    "lacuna: 1                          # version of this format\n"

#define LAW                                                                                  \
    "\n"                                                                                     \
    "# Rate-and-state friction of every contact cell:\n"                                     \
    "#   f = f0 + a ln(v/v0) + b ln(v0 theta/dc)\n"                                          \
    "# b > a: it weakens as it slips faster, and can run away; b < a: it creeps for ever.\n" \
    "friction:\n"                                                                            \
    "  aging:                           # or slip: another law for the state theta\n"        \
    "    f0: 0.6                        # friction coefficient at v0\n"                      \
    "    a: 0.010                       # direct effect of the slip rate\n"                  \
    "    b: 0.015                       # evolution with the state\n"

#define TIME                                                                                    \
    "\n"                                                                                        \
    "# Failure: the mean slip rate passes this value for the first time; the run ends there.\n" \
    "# `end` is when it ends otherwise, counted from the start.\n"

static const char block[] =
    HEAD "title: A single block on a slope\n"
         "\n"
         "# One block of this side (levels: 0): no surface, no elasticity.\n"
         "interface: {size: \"1 m\", levels: 0}\n"
         "\n"
         "# Normal load on the block. Its shear load follows from the initial state below.\n"
         "load:\n"
         "  normal: {pressure: \"3 MPa\"}\n" LAW
         "    dc: \"0.1 mm\"                   # slip that renews the contacts\n"
         "    v0: \"1 um/s\"                   # reference slip rate\n"
         "\n"
         "# At the start it creeps at this rate, with its state below the steady one: past the\n"
         "# point of no return. Above 1 it would heal and stop.\n"
         "initial:\n"
         "  slip_rate: \"1 cm/week\"\n"
         "  state: {ratio_to_steady: 0.9}\n" TIME "time:\n"
         "  start: \"2024-01-01T00:00:00Z\"\n"
         "  end: \"30 day\"\n"
         "  failure: {mean_slip_rate: \"1 cm/s\"}\n";

// The parts that the rough joints share.
#define TOUCH                                                                            \
    "  boundary: periodic               # or free: the faces end at the border\n"        \
    "\n"                                                                                 \
    "# The rock on both sides: carries stress from cell to cell, and damps fast slip.\n" \
    "material: {shear_modulus: \"20 GPa\", poisson: 0.25, shear_speed: \"3 km/s\"}\n"

#define CREEP                                                                                    \
    "    v0: \"1 um/s\"                   # reference slip rate\n"                               \
    "\n"                                                                                         \
    "# At the start the cells creep at about this rate, each a little differently, with their\n" \
    "# state below the steady one: past the point of no return.\n"                               \
    "initial:\n"                                                                                 \
    "  slip_rate: \"1 cm/week\"\n"                                                               \
    "  state: {ratio_to_steady: 0.9}\n"                                                          \
    "  spread: {slip_rate: {lognormal: {sigma: 0.5, seed: 2}}}\n"                                \
    "\n"                                                                                         \
    "# What a cell loses in slipping its neighbours gain, block by block, with stiffnesses\n"    \
    "# found from the elastic half-space on this contact.\n"                                     \
    "transfer: {hierarchy: {stiffness: elastic}}\n" TIME "time:\n"                               \
    "  start: \"2024-01-01T00:00:00Z\"    # or a bare 0\n"

static const char joint[] = HEAD
    "title: A rough joint in creep\n"
    "\n"
    "# A square of rough joint, 2^levels cells a side. Only the cells that touch are\n"
    "# computed with. More levels: finer, slower.\n"
    "interface:\n"
    "  size: \"0.5 m\"\n"
    "  levels: 7\n"
    "  surface:                         # what is left where the faces do not fit\n"
    "    self-affine: {hurst: 0.8, rms_height: \"0.03 mm\", rolloff: \"0.2 m\", seed: 1}\n" TOUCH
    "\n"
    "# Pressure that holds the joint closed. Its shear load follows from `initial`.\n"
    "load:\n"
    "  normal: {pressure: \"3 MPa\"}\n" LAW
    "    dc: \"1 mm\"                     # slip that renews the contacts\n" CREEP
    "  end: \"60 day\"\n"
    "  failure: {mean_slip_rate: \"1 cm/s\"}\n"
    "\n"
    "solver: {method: bdf, rtol: 1e-6}   # rtol: relative tolerance, smaller is finer\n"
    "\n"
    "# output: {file: joint.nc}          # else named after this file\n";

static const char slope[] = HEAD
    "title: A rough joint under a rock slope\n"
    "\n"
    "# A square of the sliding surface, 2^levels cells a side. Only the cells that touch are\n"
    "# computed with. More levels: finer, slower.\n"
    "interface:\n"
    "  size: \"256 m\"\n"
    "  levels: 7\n"
    "  surface:                         # what is left where the faces do not fit\n"
    "    self-affine: {hurst: 0.8, rms_height: \"2 cm\", rolloff: \"64 m\", seed: 1}\n" TOUCH "\n"
    "# Weight of the rock above as a pressure, and water in the joint that takes some off.\n"
    "# The shear load follows from `initial`.\n"
    "load:\n"
    "  normal: {pressure: \"3 MPa\"}\n"
    "  pore_pressure: [{constant: {value: \"0.2 MPa\"}}]\n" LAW
    "    dc: \"2 cm\"                     # slip that renews the contacts\n" CREEP
    "  end: \"1 year\"\n"
    "  failure: {mean_slip_rate: \"1 cm/s\"}\n"
    "\n"
    "solver: {method: bdf, rtol: 1e-6}   # rtol: relative tolerance, smaller is finer\n"
    "\n"
    "# A monitoring series to lay beside the run (a CSV file with a header):\n"
    "# compare: [{file: prism.csv, time: date, displacement: \"disp:mm\"}]\n";

const cli_template cli_templates[] = {{"block", block}, {"joint", joint}, {"slope", slope}, {0}};
