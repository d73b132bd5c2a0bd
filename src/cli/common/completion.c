// SPDX-License-Identifier: GPL-3.0-or-later
// The scripts that shells read: each asks the program (complete.c) what may stand at the cursor,
// and completes names of files itself.
#include <string.h>

#include "cli/common/completion.h"
#include "cli/common/words.h"
#include "data/json.h"

const char *const cli_shells[] = {"bash", "zsh", "fish", NULL};

// In the order of the shells. Bash cuts words at = and :, so what it is told begins behind those.
static const char *const scripts[] = {
    "# bash completion of lacuna, written by `lacuna completion bash`\n"
    "_lacuna() {\n"
    "    local word rest last=$2 before=${COMP_LINE:0:COMP_POINT}\n"
    "    before=${before##*[[:space:]]} before=${before%\"$2\"} before=${before%[\\'\\\"]}\n"
    "    [[ ${COMP_WORDS[COMP_CWORD]} == [=:]* ]] && last=${COMP_WORDS[COMP_CWORD]}\n"
    "    COMPREPLY=()\n"
    "    while IFS=$'\\t' read -r word rest; do\n"
    "        if [[ $word == :* ]]; then\n"
    "            _lacuna_files \"$2\" \"${word#:}\" \"$rest\"\n"
    "        else\n"
    "            [[ $word == *[.=] ]] && compopt -o nospace\n"
    "            COMPREPLY+=(\"${word#\"$before\"}\")\n"
    "        fi\n"
    "    done < <(command \"${1/#\\~\\//$HOME/}\" __complete \\\n"
    "                     \"${COMP_WORDS[@]:1:COMP_CWORD-1}\" \"$last\" 2>/dev/null)\n"
    "}\n"
    "_lacuna_files() {\n"
    "    local name=${1#\"$2\"} kind=${3:+d} ending\n"
    "    mapfile -t COMPREPLY < <(compgen \"-${kind:-f}\" -- \"$name\"\n"
    "        for ending in ${3//|/ }; do compgen -f -X \"!*.$ending\" -- \"$name\"; done)\n"
    "    if [[ $name == \"$1\" ]]; then compopt -o filenames; else "
    "COMPREPLY=(\"${COMPREPLY[@]/#/$2}\"); fi\n"
    "}\n"
    "complete -F _lacuna lacuna\n",

    "#compdef lacuna\n"
    "# zsh completion of lacuna, written by `lacuna completion zsh`\n"
    "_lacuna() {\n"
    "    local line word rest\n"
    "    local -a offers after\n"
    "    for line in ${(f)\"$(command ${~words[1]} __complete \"${(@)words[2,CURRENT-1]}\" \\\n"
    "                                 \"$PREFIX\" 2>/dev/null)\"}; do\n"
    "        word=${line%%$'\\t'*} rest=${line#*$'\\t'}\n"
    "        if [[ $word == :* ]]; then\n"
    "            compset -P \"${(b)word[2,-1]}\"\n"
    "            _files ${rest:+-g \"*.($rest)(-.)\"}\n"
    "            return\n"
    "        fi\n"
    "        [[ $word == *[.=] ]] && after=(-S '')\n"
    "        offers+=($word${rest:+:$rest})\n"
    "    done\n"
    "    _describe lacuna offers -Q \"${(@)after}\"\n"
    "}\n"
    "# As a file that zsh loads by itself this is the body of _lacuna; else it is only sourced.\n"
    "if [[ $funcstack[1] == _lacuna ]]; then _lacuna \"$@\"; else compdef _lacuna lacuna; fi\n",

    "# fish completion of lacuna, written by `lacuna completion fish`\n"
    "function __lacuna\n"
    "    set -l words (commandline -opc) (commandline -ct)\n"
    "    set words[1] (string replace -r '^~/' ~/ -- $words[1])\n"
    "    command -q $words[1]; and command $words[1] __complete $words[2..] 2>/dev/null\n"
    "end\n"
    "complete -c lacuna -f -a '(__lacuna | string match -v \":*\")'\n"
    "complete -c lacuna -n '__lacuna | string match -q \":*\"' -F\n"};

lac_status cli_completion(const cli_request *request, lac_error *err)
{
    size_t i = 0;
    while (cli_shells[i] != NULL && strcmp(cli_shells[i], request->argument[0]) != 0) {
        i++;
    }
    if (cli_shells[i] == NULL) {
        return cli_unknown("completion: ", request->argument[0], "shell", cli_shells, i, err);
    }
    if (!cli_given(request, CLI_OPT_JSON)) {
        (void)fputs(scripts[i], stdout);
        return LAC_OK;
    }
    lac_json json = {.out = stdout};
    lac_json_open(&json, NULL, '{');
    lac_json_text(&json, "shell", cli_shells[i]);
    lac_json_text(&json, "script", scripts[i]);
    lac_json_close(&json, '}');
    return LAC_OK;
}
