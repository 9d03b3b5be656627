// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Isophote as a library: load or build a world, choose settings, render, read the picture.
//
//   #include <isophote/isophote.h>
//
//   int main() {
//     const isophote::World world = isophote::World::load("cornell-box");
//     isophote::Settings settings;
//     settings.apply(world).set("frame.width", 512).set("frame.height", 512);
//     isophote::Renderer renderer(world, settings);
//     renderer.render().save("cornell.png");
//   }
//
// Every call that can fail throws isophote::Error and nothing else. The library prints nothing, installs no
// signal handler and keeps no global state.
#pragma once

#include "isophote/error.h"
#include "isophote/job.h"
#include "isophote/picture.h"
#include "isophote/renderer.h"
#include "isophote/settings.h"
#include "isophote/world.h"
