"""Renders the manifests and checks them against the types of the Kubernetes API, without a cluster.

    python deploy/kubernetes/check.py

Needs kubectl and the extra `k8s`; the settings of Herijk are read by Herijk. Found are unknown
fields, missing ones and wrong kinds of value; not found is what only a cluster knows: images,
secrets, storage classes, rights.
"""

import subprocess
import sys
from pathlib import Path

import yaml
from dagster._config import process_config, resolve_to_config_type
from dagster_k8s import K8sRunLauncher
from kubernetes import client

from herijk.assets.settings import read_settings
from herijk.warehouse.store.storage import read_locations

HERE = Path(__file__).parent
MODELS = {
    "ConfigMap": client.V1ConfigMap,
    "CronJob": client.V1CronJob,
    "Deployment": client.V1Deployment,
    "NetworkPolicy": client.V1NetworkPolicy,
    "PersistentVolumeClaim": client.V1PersistentVolumeClaim,
    "Service": client.V1Service,
}
READERS = {"beheer.toml": read_settings, "opslag.toml": read_locations}


def faults(value, kind, where):
    """What does not fit a type of the API, named as the API does."""
    if kind.startswith("list["):
        if not isinstance(value, list):
            return [f"{where}: a list is expected"]
        inner = kind[5:-1]
        return [f for i, one in enumerate(value) for f in faults(one, inner, f"{where}[{i}]")]
    model = getattr(client, kind, None)
    if model is None:  # text, numbers, dictionaries of text
        return [f"{where}: nothing stands here"] if value is None else []
    if not isinstance(value, dict):
        return [f"{where}: fields are expected"]
    names = {there: ours for ours, there in model.attribute_map.items()}
    found = [f"{where}.{key}: no such field" for key in value.keys() - names.keys()]
    for key in value.keys() & names.keys():
        found += faults(value[key], model.openapi_types[names[key]], f"{where}.{key}")
    try:  # the model itself refuses where a field is missing
        model(**{names[key]: one for key, one in value.items() if key in names})
    except ValueError as error:
        found.append(f"{where}: {error}")
    return found


def main():
    rendered = subprocess.run(
        ["kubectl", "kustomize", str(HERE)], check=True, capture_output=True, text=True
    ).stdout
    objects = list(yaml.safe_load_all(rendered))
    found = [
        fault
        for one in objects
        for fault in faults(one, MODELS[one["kind"]].__name__, one["metadata"]["name"])
    ]
    launcher = yaml.safe_load((HERE / "dagster.yaml").read_text())["run_launcher"]["config"]
    checked = process_config(resolve_to_config_type(K8sRunLauncher.config_type()), launcher)
    found += [f"run_launcher: {error.message}" for error in checked.errors or ()]
    for read in READERS.values():
        read(HERE)  # stops where one is wrong
    print(
        f"{len(objects)} objects, the run launcher and {' and '.join(READERS)} checked",
        *found,
        sep="\n",
    )
    sys.exit(bool(found))


if __name__ == "__main__":
    main()
