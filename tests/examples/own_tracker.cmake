# SPDX-License-Identifier: Apache-2.0
# A comparison that trains a correction of the user's own tracker: every tracker has finite errors, and the correction
# makes the user's smaller.
execute_process(COMMAND ${PROGRAM} compare ${STUDY} --retrain --runs 50 --quiet --json - OUTPUT_VARIABLE json
                COMMAND_ERROR_IS_FATAL ANY)
foreach(tracker plain alpha_beta corrected)
  string(JSON rmse GET ${json} trackers ${tracker} rmse position_m)
  if(NOT rmse MATCHES "^[0-9]+(\\.[0-9]+)?$")
    message(FATAL_ERROR "RMSE of ${tracker}: ${rmse}\n${json}")
  endif()
endforeach()
string(JSON difference GET ${json} paired "corrected - alpha_beta" position_m mean)
if(NOT difference LESS 0)
  message(FATAL_ERROR "corrected - alpha_beta: ${difference} m")
endif()
