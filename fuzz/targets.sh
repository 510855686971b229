# Sourced: what the fuzzers of a target are told of its inputs.

# Of bytes that scenes are made of, a few hundred are a scene.
longest_of() {  # TARGET
    case $1 in laws | caustics | fit | maps | radiosity | suite | terrain) echo 400 ;; *) echo 8192 ;; esac
}

# Whether its inputs are JSON, so that the schema's words are its dictionary.
is_json() {  # TARGET
    case $1 in scene | animation | gltf | sweep | test | run | wish) return 0 ;; *) return 1 ;; esac
}
