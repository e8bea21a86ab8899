// The Khronos validator: neither errors nor warnings.
const fs = require("fs");
const path = require("path");
const validator = require("gltf-validator");

async function main(folder) {
  const names = fs.readdirSync(folder).filter((name) => /\.(glb|gltf)$/.test(name));
  for (const name of names.sort()) {
    const bytes = new Uint8Array(fs.readFileSync(path.join(folder, name)));
    const { issues, info } = await validator.validateBytes(bytes, { uri: name });
    const { numErrors, numWarnings, numInfos, messages } = issues;
    const outcome =
      numErrors + numWarnings > 0
        ? `FAULT: ${JSON.stringify(messages[0])}`
        : `ok, ${info.totalTriangleCount} triangles, ${numInfos} remarks`;
    console.log(`Khronos validator ${validator.version()}\t${name}\t${outcome}`);
  }
}

main(process.argv[2]);
