// A client of `lightfit serve`: sends a read-back, prints the lightfit.v1.FitResult as JSON.
//   npm ci && node fit.mjs 127.0.0.1:50071 request.json depth.f32 shadow.u32
// ../write_request.py writes the three files. Read-backs above the server's --max-message-mib are
// streamed, which ../cpp_client shows.
import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import grpc from "@grpc/grpc-js";
import protoLoader from "@grpc/proto-loader";

const protos = process.env.LIGHTFIT_PROTO ?? fileURLToPath(new URL("../../proto", import.meta.url));
const options = { includeDirs: [protos], enums: String, longs: String };
const definition = protoLoader.loadSync("lightfit/v1/service.proto", options);
const { LightFit } = grpc.loadPackageDefinition(definition).lightfit.v1;

const [address, requestFile, depthFile, shadowFile] = process.argv.slice(2);
if (!shadowFile) {
  console.error("usage: node fit.mjs HOST:PORT request.json depth.f32 shadow.u32");
  process.exit(1);
}
const request = JSON.parse(readFileSync(requestFile, "utf8"));
request.readback.depth = readFileSync(depthFile);
request.readback.shadowBits = readFileSync(shadowFile);

// Proxies of the environment are for other machines.
const isHere = /^(unix:|(dns:\/*|ipv[46]:)?(localhost|127\.[\d.]+|\[::1\]):)/i.test(address);
const channel = { "grpc.enable_http_proxy": isHere ? 0 : 1 };
const proxy = ["grpc_proxy", "https_proxy", "http_proxy"].find((name) => name in process.env && !isHere);
const client = new LightFit(address, grpc.credentials.createInsecure(), channel);
client.fit(request, { deadline: Date.now() + 60_000 }, (error, result) => {
  const way = proxy ? `; unless no_proxy names it, it was asked through ${proxy}` : "";
  if (error) console.error(`fit: ${address}: ${grpc.status[error.code]}: ${error.details}${way}`);
  else console.log(JSON.stringify(result, null, 1));
  process.exitCode = error ? 1 : 0;
  client.close();
});
