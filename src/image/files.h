// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/exr.h"
#include "image/image.h"
#include "image/tonemap.h"

#include <filesystem>

namespace isophote {

/// Reads an OpenEXR, Radiance HDR, PNG, JPEG or TGA file, told apart by its content; the latter three are
/// taken as sRGB. Throws an Error that names the file.
Film readFilm(const std::filesystem::path& path, std::uint64_t budgetBytes = kFilmBudgetBytes);

enum class FilmFormat { kExr, kPng };

/// The format that writeFilm() chooses by the ending of the file's name. Throws Error(kBadUsage) where it
/// knows none.
FilmFormat filmFormat(const std::filesystem::path& path);
/// Throws what filmFormat() throws: to be called before long work.
void requireFilmFormat(const std::filesystem::path& path);

/// Whether writeFilm() writes the film's layers into a file of that name.
bool holdsLayers(const std::filesystem::path& path);

/// Writes the film as the ending of the name says: ".exr" everything in it, ".png" the picture as `display`
/// shows it. Whole or not at all: into a temporary file beside it that is then renamed.
void writeFilm(const std::filesystem::path& path, const Film& film, const DisplayOptions& display = {});

}  // namespace isophote
