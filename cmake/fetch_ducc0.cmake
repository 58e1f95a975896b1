# The transforms are the BSD-3-Clause FFT files of ducc0, taken from its pinned source archive at build time.
# Offline: -DRDPM_DUCC0_DIR=/path/to/unpacked/ducc0-0.42.0
set(RDPM_DUCC0_VERSION 0.42.0)
set(RDPM_DUCC0_SHA256 4e11c59b53a43355b053aebb2a62ee16eebeed026575f7d216cf09d437ce52ef)
set(RDPM_DUCC0_DIR "" CACHE PATH "An unpacked ducc0 source archive; empty: fetched from the package index")

function(rdpm_fetch_ducc0)
  if(RDPM_DUCC0_DIR)
    set(ducc0_source "${RDPM_DUCC0_DIR}")
  else()
    set(store "${CMAKE_CURRENT_BINARY_DIR}/ducc0")
    set(archive "${store}/ducc0-${RDPM_DUCC0_VERSION}.tar.gz")
    set(ducc0_source "${store}/ducc0-${RDPM_DUCC0_VERSION}")
    if(NOT EXISTS "${archive}")
      message(STATUS "Fetching ducc0 ${RDPM_DUCC0_VERSION} (source archive)")
      execute_process(
        COMMAND "${Python_EXECUTABLE}" -m pip download --quiet --disable-pip-version-check --no-deps
                --no-binary=ducc0 --no-build-isolation --dest "${store}" "ducc0==${RDPM_DUCC0_VERSION}"
        RESULT_VARIABLE failed
        ERROR_VARIABLE message)
      if(failed)
        message(FATAL_ERROR "ducc0's source archive could not be fetched:\n${message}\n"
                            "Without a package index, set RDPM_DUCC0_DIR to an unpacked copy.")
      endif()
    endif()
    file(SHA256 "${archive}" found)
    if(NOT found STREQUAL RDPM_DUCC0_SHA256)
      message(FATAL_ERROR "${archive}: SHA-256 is ${found}, expected ${RDPM_DUCC0_SHA256}. Delete it and build again.")
    endif()
    if(NOT EXISTS "${ducc0_source}/src")
      file(ARCHIVE_EXTRACT INPUT "${archive}" DESTINATION "${store}")
    endif()
  endif()
  if(NOT EXISTS "${ducc0_source}/src/ducc0/fft/fft.h")
    message(FATAL_ERROR "RDPM_DUCC0_DIR = ${ducc0_source}: no src/ducc0/fft/fft.h below it. Name the unpacked archive's top folder.")
  endif()
  set(ducc0_include "${ducc0_source}/src" PARENT_SCOPE)
  set(ducc0_root "${ducc0_source}" PARENT_SCOPE)
endfunction()
