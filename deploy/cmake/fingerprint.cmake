# SPDX-License-Identifier: Apache-2.0
# cmake -DOUTPUT=HEADER -DFILES=LIST -P fingerprint.cmake: a header that names the content of the files, all in one hash.
set(all "")
foreach(file IN LISTS FILES)
  file(SHA256 ${file} hash)
  string(APPEND all ${hash})
endforeach()
string(SHA256 fingerprint "${all}")
file(WRITE ${OUTPUT} "// Made by deploy/cmake/fingerprint.cmake.\n#pragma once\n#define FARFIELD_SCENE_FINGERPRINT \"${fingerprint}\"\n")
