// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What photon_volumes.comp and photon_volumes_vulkan.cpp agree on.
#ifndef ISOPHOTE_STAGES_PHOTON_VOLUMES_SHARED_H
#define ISOPHOTE_STAGES_PHOTON_VOLUMES_SHARED_H

#include "physics/photon.shared.h"
#include "stages/gbuffer/view_tile.shared.h"

SHARED_BEGIN

SHARED_CONST uint kBindViewTiles = 0u;     ///< ViewTile[]
SHARED_CONST uint kBindVolumes = 1u;       ///< PhotonVolume[]
SHARED_CONST uint kBindListBegin = 2u;     ///< uint[tiles + 1]: where each tile's part of the list begins.
SHARED_CONST uint kBindList = 3u;          ///< uint[]: indices into the volumes, ascending in a tile.
SHARED_CONST uint kBindRadiance = 4u;      ///< RadianceTile[], added to.
SHARED_CONST uint kBindContributing = 5u;  ///< uint[tiles]: pairs that contributed, added to.

struct PhotonVolumesPush {
  uint kernel;    ///< kKernel...
  uint lastPart;  ///< 1: no photons follow for these tiles, so that Lambertian ones turn irradiance to
                  ///< radiance.
};

SHARED_END

#endif
