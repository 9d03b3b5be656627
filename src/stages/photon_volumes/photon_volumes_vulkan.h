// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/photon_volumes/photon_volumes.h"

namespace isophote {

class GpuDevice;

/// PhotonVolumes on a Vulkan device: the CPU bins the photons to tiles, the device estimates the radiance,
/// one workgroup a tile. Values agree with the CPU's but for the rounding of the device.
class PhotonVolumesVulkan {
 public:
  /// The device must outlive this. Throws Error(kDevice) where it refuses the shader.
  PhotonVolumesVulkan(GpuDevice& device, PhotonVolumesSettings settings);
  ~PhotonVolumesVulkan();
  PhotonVolumesVulkan(PhotonVolumesVulkan&&) noexcept;
  PhotonVolumesVulkan& operator=(PhotonVolumesVulkan&&) noexcept;

  /// As PhotonVolumes::run, with the counter photon_volumes.deviceMilliseconds besides: the device's own
  /// time. A stop takes effect between two dispatches.
  void run(const PhotonVolumes::In& in, Radiance& out, Stats& stats, const Job& job = {});

 private:
  struct Engine;
  std::unique_ptr<Engine> engine_;
};

}  // namespace isophote
